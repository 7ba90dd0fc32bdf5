#include <cstdio>
#include <filesystem>

#include "ext/lab/inspect.h"
#include "ext/lab/lab_scene.h"
#include "ext/lab/results.h"
#include "ext/lab/run_record.h"
#include "pbrt/core/error.h"
#include "pbrt/core/files.h"
#include "pbrt/core/log.h"
#include "pbrt/core/version.h"
#include "pbrt/images/false_color.h"
#include "pbrt/integrators/direction_sampling.h"
#include "pbrt/scenefile/parser.h"

namespace ext::lab {

namespace fs = std::filesystem;

namespace {

constexpr int kLegendRows = 12;

void MakeFolder(const std::string &folder) {
    std::error_code failed;
    fs::create_directories(folder, failed);
    if (failed) throw UserError(fmt::format("{}: {}.", folder, failed.message()));
}

Json LayerJson(const InspectedLayer &layer, const std::string &file) {
    Json json;
    json["name"] = layer.name;
    json["file"] = layer.IsFlat() ? Json() : Json(file);
    json["meaning"] = layer.meaning;
    if (layer.isId) json["colours"] = "one per number, without order";
    else json["colours"] = {{"darkest", layer.shownLeast}, {"brightest", layer.shownMost}};
    if (!layer.light.empty()) json["light"] = layer.light;
    json["isFlat"] = layer.IsFlat();
    if (layer.values > 0) {
        json["least"] = layer.least;
        json["most"] = layer.most;
        json["mean"] = layer.mean;
    }
    return json;
}

}  // namespace

Json WriteLayers(const Inspection &inspection, const std::string &folder, int legendRows,
                 const std::function<bool(const InspectedLayer &)> &wanted) {
    MakeFolder(folder);
    const Image hit = inspection.image.Select({"hit"});
    Json json = Json::array();
    for (size_t c = 0; c < inspection.layers.size(); ++c) {
        const InspectedLayer &layer = inspection.layers[c];
        if (!wanted(layer)) continue;
        FalseColorStyle style;
        style.scale = layer.isId ? FalseColorStyle::Scale::Id : FalseColorStyle::Scale::Ramp;
        style.least = static_cast<Float>(layer.shownLeast);
        style.most = static_cast<Float>(layer.shownMost);
        style.legendRows = legendRows;
        const std::string file = layer.name + ".png";
        if (layer.IsFlat()) fs::remove(fs::path(folder) / file);  // removes images of earlier inspections
        else WriteImage(folder + "/" + file, FalseColor(inspection.image, static_cast<int>(c), style, &hit));
        json.push_back(LayerJson(layer, file));
    }
    return json;
}

void WriteInspection(const Inspection &inspection, const std::string &folder, const Json &about) {
    MakeFolder(folder);
    const fs::path out(folder);
    Json json = about;
    json["note"] =
        "Dark grey: nothing visible. Magenta: not finite. The bar below a picture runs from the "
        "darkest to the brightest colour.";
    json["everyNthPixel"] = inspection.stride;
    json["lights"] = Json::array();
    for (const InspectedLight &light : inspection.lights)
        json["lights"].push_back(
            {{"first", light.first.value}, {"count", light.count}, {"power", light.power}, {"label", light.label}});

    WriteImage((out / "inspect.exr").string(), inspection.image);
    json["layers"] = WriteLayers(inspection, folder, kLegendRows, [](const InspectedLayer &) { return true; });
    ShortenFloats(&json);
    WriteFile((out / "inspect.json").string(), json.dump(2) + "\n");
    WriteFile((out / "structure.txt").string(),
              inspection.structure.empty() ? "no learned structure\n" : inspection.structure);
    WriteFile((out / "index.html").string(), InspectPage(json, inspection.structure));
}

int RunInspect(const InspectOptions &options, const PluginRegistry &registry, Progress &progress) {
    DiagnosticSink sink;
    progress.BeginPhase("reading", 0);
    SceneDescription description = ParseSceneFiles(options.sceneFiles, sink);
    sink.ThrowIfErrors();
    progress.EndPhase();
    progress.BeginPhase("building", 0);
    BuiltScene built = BuildScene(description, options.build, registry, sink, progress);
    progress.EndPhase();
    CheckSamplesLights(built, options.sceneFiles.front());
    for (const Diagnostic &d : sink.All())
        if (d.severity == Severity::Warning) LogInfo(Format(d, false));

    built.Prepare(progress);
    if (progress.Cancelled()) return 130;
    if (built.integrator->Directions()) {
        // The guide learns during rendering; the image is discarded.
        RenderSettings settings = built.Settings();
        RenderWaves(built.Rendering(progress), settings);
        if (progress.Cancelled()) return 130;
    }
    Inspection inspection = InspectLights(built, *built.integrator, options.settings, progress);
    if (progress.Cancelled()) return 130;

    Json about;
    about["scene"] = options.sceneFiles;
    about["sampler"] = built.lightSamplerName;
    Json report = Json::object();
    built.integrator->Lights()->Report(report);
    about["samplerReport"] = report;
    if (const DirectionSampling *guide = built.integrator->Directions()) {
        report = Json::object();
        guide->Report(report);
        about["guideReport"] = report;
    }
    about["commandLine"] = options.commandLine;
    about["version"] = VersionText();
    about["seed"] = built.seed;
    about["samplesPerLight"] = options.settings.samples;
    const std::string folder = options.outFolder.empty() ? "inspect-" + built.lightSamplerName : options.outFolder;
    WriteInspection(inspection, folder, about);

    std::printf(
        "%s", inspection.structure.empty() ? "The sampler has no learned structure.\n" : inspection.structure.c_str());
    std::printf("\n%-28s %12s %12s %12s\n", "layer", "least", "mean", "most");
    for (const InspectedLayer &layer : inspection.layers)
        if (!layer.isId)
            std::printf("%-28s %12.4g %12.4g %12.4g\n", layer.name.c_str(), layer.least, layer.mean, layer.most);
    if (inspection.stride > 1)
        std::printf("There are %zu lights, so only every %d-th pixel of every row and column was inspected.\n",
                    inspection.lights.size(), inspection.stride);
    std::printf("Wrote %s; index.html shows it.\n", folder.c_str());
    return 0;
}

}  // namespace ext::lab
