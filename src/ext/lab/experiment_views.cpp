#include "ext/lab/experiment_views.h"

#include <filesystem>

#include "ext/lab/inspect.h"

namespace ext::lab {

namespace fs = std::filesystem;

namespace {

constexpr const char *kFolder = "views";

/// Coarser than `lightlab inspect`: some seconds on two cores for any number of lights.
InspectSettings ViewSettings() {
    InspectSettings s;
    s.samples = 8;
    s.shownLights = 4;
    s.maxWork = 2e7;
    return s;
}

Json WithFolder(Json layers, const std::string &folder) {
    for (Json &layer : layers)
        if (layer["file"].is_string()) layer["file"] = folder + "/" + layer["file"].get<std::string>();
    return layers;
}

}  // namespace

std::string ViewsNote(const SamplerChoice &choice) { return choice.folder + "/views.json"; }

Json WriteViews(const ExperimentSettings &settings, const LabScene &scene, size_t sampler, const Integrator &integrator,
                Progress &cancel) {
    InspectSettings how = ViewSettings();
    if (sampler > 0) how.shownLights = 0;
    const Inspection inspection = InspectLights(scene.built, integrator, how, cancel);
    if (cancel.Cancelled()) return {};
    auto write = [&](const std::string &folder, bool ofScene) {
        return WithFolder(
            WriteLayers(inspection, settings.outFolder + "/" + folder, 0,
                        [&](const InspectedLayer &layer) { return layer.name != "hit" && layer.ofScene == ofScene; }),
            folder);
    };
    Json views;
    views["everyNthPixel"] = inspection.stride;
    views["samplesPerLight"] = how.samples;
    views["layers"] = write(settings.samplers[sampler].folder + "/" + kFolder, false);
    if (sampler == 0) views["layersOfScene"] = write(kFolder, true);
    views["bytes"] = Json::object();
    for (const char *part : {"layers", "layersOfScene"})
        for (const Json &layer : views.value(part, Json::array()))
            if (layer.at("file").is_string()) {
                const std::string file = layer.at("file").get<std::string>();
                views["bytes"][file] = fs::file_size(fs::path(settings.outFolder) / file);
            }
    return views;
}

bool ViewsAreWhole(const ExperimentSettings &settings, const Json &note) {
    if (!note.is_object()) return false;
    std::error_code error;
    for (const auto &[file, bytes] : note.at("bytes").items())
        if (fs::file_size(fs::path(settings.outFolder) / file, error) != bytes || error) return false;
    return true;
}

void AddViews(const ExperimentSettings &settings, const RecordFolder &records, Json *results) {
    for (size_t i = 0; i < settings.samplers.size(); ++i) {
        const Json views = records.LoadNote(ViewsNote(settings.samplers[i]));
        if (!views.is_object()) continue;
        auto part = [&](const char *layers) {
            return Json{{"everyNthPixel", views.at("everyNthPixel")},
                        {"samplesPerLight", views.at("samplesPerLight")},
                        {"layers", views.at(layers)}};
        };
        (*results)["samplers"][i]["views"] = part("layers");
        if (views.contains("layersOfScene")) (*results)["views"] = part("layersOfScene");
    }
}

}  // namespace ext::lab
