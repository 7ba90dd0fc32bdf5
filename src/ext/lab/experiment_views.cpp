#include "ext/lab/experiment.h"

#include <filesystem>

#include "ext/lab/inspect.h"
#include "ext/lab/pictures.h"

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

void WritePictures(const ExperimentSettings &settings, const LabScene &scene, const References &references,
                   const std::vector<std::vector<Image>> &pictures, Json *json) {
    const double exposure = ChooseExposure(references.all[0].image);
    const Point2i resolution = references.all[0].image.Resolution();
    (*json)["references"] = Json::array();
    for (size_t i = 0; i < references.all.size(); ++i) {
        const Reference &r = references.all[i];
        const std::string name = fmt::format("reference-{}", i);
        ImageMetadata metadata = scene.built.film->Metadata();
        metadata.attributes["lightlab.sampler"] = r.sampler;
        metadata.attributes["lightlab.sceneHash"] = scene.hash;
        metadata.attributes["samplesPerPixel"] = r.samples;
        WriteImage(fmt::format("{}/{}.exr", settings.outFolder, name), r.image, metadata);
        WritePicture(fmt::format("{}/{}.png", settings.outFolder, name), r.image, exposure);
        WriteRangePicture(fmt::format("{}/{}.hdr", settings.outFolder, name), r.image);
        (*json)["references"].push_back({{"file", name + ".exr"},
                                         {"picture", name + ".png"},
                                         {"pictureRange", name + ".hdr"},
                                         {"sampler", r.sampler.empty() ? Json() : Json(r.sampler)},
                                         {"samples", r.samples ? Json(r.samples) : Json()},
                                         {"seconds", r.seconds > 0 ? Json(r.seconds) : Json()},
                                         {"noise", r.noise ? Json(*r.noise) : Json()},
                                         {"source", r.source}});
    }
    std::vector<std::vector<float>> maps, shared;
    for (size_t i = 0; i < settings.samplers.size(); ++i) {
        maps.push_back(ErrorMap(pictures[i].front(), references.all[references.ofSampler[i]].image));
        if (!settings.samplers[i].IsOracle()) shared.push_back(maps.back());
    }
    const double scale = ChooseErrorScale(maps);
    for (size_t i = 0; i < settings.samplers.size(); ++i) {
        const std::string folder = settings.outFolder + "/" + settings.samplers[i].folder;
        WritePicture(folder + "/result.png", pictures[i].front(), exposure);
        WriteRangePicture(folder + "/result.hdr", pictures[i].front());
        WriteErrorPicture(folder + "/error.png", maps[i], resolution, scale);
    }
    (*json)["exposure"] = exposure;
    (*json)["errorScale"] = scale;
    (*json)["crops"] = Json::array();
    const std::vector<Bounds2i> crops = settings.crops.empty() ? ChooseCrops(shared, resolution) : settings.crops;
    for (size_t i = 0; i < crops.size(); ++i)
        (*json)["crops"].push_back({{"name", std::string(1, static_cast<char>('a' + i % 26))},
                                    {"x0", crops[i].low.x},
                                    {"y0", crops[i].low.y},
                                    {"x1", crops[i].high.x},
                                    {"y1", crops[i].high.y}});
}

}  // namespace ext::lab
