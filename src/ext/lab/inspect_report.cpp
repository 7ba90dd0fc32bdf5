#include "ext/lab/inspect.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <ranges>

#include "ext/lab/experiment_settings.h"
#include "ext/lab/results.h"
#include "pbrt/core/files.h"
#include "pbrt/core/version.h"
#include "pbrt/images/false_color.h"
#include "pbrt/integrators/direction_sampling.h"
#include "pbrt/scenefile/parser.h"

namespace ext::lab {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMaxLights = 100;
constexpr int kLegendRows = 12;

constexpr const char *kHead = R"(<style>
:root { color-scheme: light dark; }
body { margin: 0 auto; max-width: 1400px; padding: 24px 28px; font: 15px/1.5 system-ui, "DejaVu Sans", sans-serif; }
h1 { margin: 0; font-size: 28px; } h2 { margin: 32px 0 12px; font-size: 19px; }
.pictures { display: grid; grid-template-columns: repeat(auto-fill, minmax(300px, 1fr)); gap: 20px 18px; }
figure { margin: 0; } img { width: 100%; image-rendering: pixelated; }
figcaption { font-size: 13px; line-height: 1.4; overflow-wrap: anywhere; } figcaption b { display: block; }
table { border-collapse: collapse; font-size: 14px; } th, td { padding: 4px 14px 4px 0; text-align: left; }
td.number { text-align: right; font-variant-numeric: tabular-nums; }
pre { overflow: auto; font-size: 13px; }
</style>
)";

std::string Number(const Json &value) {
    return value.is_number() ? fmt::format("{:.4g}", value.get<double>()) : "unknown";
}

std::string Figure(const Json &layer) {
    const Json &colours = layer.at("colours");
    std::string range = "a colour for each";
    if (colours.is_object())
        range = fmt::format("colours from {} to {}; here {} to {}, mean {}", Number(colours.at("darkest")),
                            Number(colours.at("brightest")), Number(layer.at("min")), Number(layer.at("max")),
                            Number(layer.at("mean")));
    const std::string name = EscapeHtml(layer.at("name")), file = EscapeHtml(layer.at("file"));
    return fmt::format(
        "<figure id=\"{0}\"><a href=\"{1}\"><img src=\"{1}\" alt=\"{0}\"></a><figcaption><b>{0}</b>{2}; "
        "{3}.</figcaption></figure>\n",
        name, file, EscapeHtml(layer.at("meaning")), range);
}

std::string FlatText(const Json &layers) {
    std::string same, unknown, text;
    for (const Json &layer : layers) {
        if (!layer.at("isFlat")) continue;
        const std::string name = layer.at("name");
        const std::string subject =
            layer.contains("light") ? "visibility of " + layer.at("light").get<std::string>() : name;
        if (!layer.contains("min")) unknown += (unknown.empty() ? "" : "; ") + subject;
        else if (name == "sampler.leaf") text += "One leaf covers everything visible. ";
        else if (name == "brightest")
            text += "One light contributes most everywhere: " + layer.value("light", name) + ". ";
        else same += (same.empty() ? "" : "; ") + subject + " " + Number(layer.at("min"));
    }
    if (!same.empty()) text += "The same everywhere: " + same + ". ";
    if (!unknown.empty()) text += "No value anywhere: " + unknown + ". ";
    return text.empty() ? "" : "<p id=\"flat\">" + EscapeHtml(text) + "</p>\n";
}

std::string LightRows(const Json &lights) {
    std::vector<Json> sorted(lights.begin(), lights.end());
    std::ranges::stable_sort(sorted, std::greater(), [](const Json &l) { return l.at("power").get<double>(); });
    std::string rows;
    for (const Json &light : sorted | std::views::take(kMaxLights))
        rows += fmt::format("<tr><td>{}</td><td class=\"number\">{}</td><td class=\"number\">{}</td></tr>\n",
                            EscapeHtml(light.at("label")), Number(light.at("first")), Number(light.at("power")));
    return rows;
}

/// HTML page for the images in the same folder: captioned images, sentences for flat layers, lights, structure.
std::string InspectPage(const Json &inspection, const std::string &structure) {
    const Json &layers = inspection.at("layers"), &lights = inspection.at("lights");
    const std::string sampler = EscapeHtml(inspection.value("sampler", "")),
                      scene = EscapeHtml(inspection.value("scene", Json::array()).dump());
    std::string page = std::string(kPageHead) + kHead;
    page += fmt::format("<title>{} · lightlab inspect</title>\n</head>\n<body>\n<h1>{}</h1>\n", sampler, sampler);
    page += fmt::format(
        "<p>State of the light sampler at the first visible surface that is not purely specular. Scene: {}. {}</p>\n",
        scene, EscapeHtml(inspection.value("note", "")));
    page += FlatText(layers) + "<div class=\"pictures\">\n";
    for (const Json &layer : layers)
        if (layer.at("file").is_string()) page += Figure(layer);
    page += fmt::format(
        "</div>\n<h2>Lights</h2>\n<p>{} lights or emissive meshes{}. \"first\" is the number that the images' names "
        "use.</p>\n",
        lights.size(), lights.size() > kMaxLights ? fmt::format("; the {} of most power", kMaxLights) : "");
    page += "<table id=\"lights\"><tr><th>place in the scene file</th><th>first</th><th>power</th></tr>\n" +
            LightRows(lights) + "</table>\n";
    page += "<h2>Structure</h2>\n<pre>" + EscapeHtml(structure.empty() ? "no learned structure" : structure) +
            "</pre>\n</body>\n</html>\n";
    return page;
}

Json LayerJson(const InspectedLayer &layer, const std::string &file) {
    Json json;
    json["name"] = layer.name;
    json["file"] = layer.IsFlat() ? Json() : Json(file);
    json["meaning"] = layer.meaning;
    if (layer.isId) json["colours"] = "one per number, without order";
    else json["colours"] = {{"darkest", layer.shownMin}, {"brightest", layer.shownMax}};
    if (!layer.light.empty()) json["light"] = layer.light;
    json["isFlat"] = layer.IsFlat();
    if (layer.values > 0) {
        json["min"] = layer.min;
        json["max"] = layer.max;
        json["mean"] = layer.mean;
    }
    return json;
}

}  // namespace

Json WriteLayers(const Inspection &inspection, const std::string &folder, const std::string &prefix, int legendRows,
                 const std::function<bool(const InspectedLayer &)> &wanted) {
    MakeFolder((fs::path(folder) / prefix).parent_path().string());
    const Image hit = inspection.image.Select({"hit"});
    Json json = Json::array();
    for (size_t c = 0; c < inspection.layers.size(); ++c) {
        const InspectedLayer &layer = inspection.layers[c];
        if (!wanted(layer)) continue;
        const FalseColorStyle style{layer.isId ? FalseColorStyle::Scale::Id : FalseColorStyle::Scale::Ramp,
                                    Float(layer.shownMin), Float(layer.shownMax), legendRows};
        const std::string file = prefix + layer.name + ".png";
        if (layer.IsFlat()) fs::remove(fs::path(folder) / file);  // removes images of earlier inspections
        else WriteImage(folder + "/" + file, FalseColor(inspection.image, int(c), style, &hit));
        json.push_back(LayerJson(layer, file));
    }
    return json;
}

void WriteInspection(const Inspection &inspection, const std::string &folder, const Json &about) {
    MakeFolder(folder);
    const std::string out = folder + "/";
    Json json = about;
    json["note"] =
        "Dark grey: nothing visible. Magenta: not finite. The bar below an image runs from the "
        "darkest to the brightest colour.";
    json["everyNthPixel"] = inspection.stride;
    json["lights"] = Json::array();
    for (const InspectedLight &light : inspection.lights)
        json["lights"].push_back(
            {{"first", light.first.value}, {"count", light.count}, {"power", light.power}, {"label", light.label}});

    WriteImage(out + "inspect.exr", inspection.image);
    json["layers"] = WriteLayers(inspection, folder, "", kLegendRows, [](const InspectedLayer &) { return true; });
    ShortenFloats(&json);
    WriteFile(out + "inspect.json", json.dump(2) + "\n");
    WriteFile(out + "structure.txt", inspection.structure.empty() ? "no learned structure\n" : inspection.structure);
    WriteFile(out + "index.html", InspectPage(json, inspection.structure));
}

int RunInspect(const InspectOptions &options, const PluginRegistry &registry, Progress &progress) {
    DiagnosticSink sink;
    progress.BeginPhase("reading", 0);
    SceneDescription description = ParseSceneFiles(options.sceneFiles, sink);
    sink.ThrowIfErrors();
    progress.EndPhase();
    BuiltScene built = BuildLitScene(description, options.sceneFiles.front(), options.build, registry, sink, progress);
    const std::string &typed = options.build.lightSampler;
    const std::string label =
        (typed.empty() ? built.lightSamplerName : typed) + (options.build.meshLights ? "+mesh" : "");
    const std::string folder = options.outFolder.empty() ? "inspect-" + SafeFileName(label) : options.outFolder;
    MakeFolder(folder);  // an error comes before the work

    built.Prepare(progress);
    // A guide learns during rendering; the image is discarded.
    if (built.integrator->Directions() && !progress.Cancelled())
        RenderWaves(built.Rendering(progress), built.Settings());
    if (progress.Cancelled()) return 130;
    Inspection inspection =
        InspectLights(built, *built.integrator->Lights(), built.integrator.get(), options.settings, progress);
    if (progress.Cancelled()) return 130;

    Json about;
    about["scene"] = options.sceneFiles;
    about["sampler"] = label;
    built.integrator->Lights()->Report(about["samplerReport"] = Json::object());
    if (const DirectionSampling *guide = built.integrator->Directions())
        guide->Report(about["guideReport"] = Json::object());
    about["commandLine"] = options.commandLine;
    about["version"] = VersionText();
    about["seed"] = built.seed;
    about["samplesPerLight"] = options.settings.samples;
    WriteInspection(inspection, folder, about);

    std::printf(
        "%s", inspection.structure.empty() ? "The sampler has no learned structure.\n" : inspection.structure.c_str());
    std::printf("\n%-28s %12s %12s %12s\n", "layer", "min", "mean", "max");
    for (const InspectedLayer &layer : inspection.layers)
        if (!layer.isId && layer.values > 0)
            std::printf("%-28s %12.4g %12.4g %12.4g\n", layer.name.c_str(), layer.min, layer.mean, layer.max);
        else if (!layer.isId) std::printf("%-28s %12s %12s %12s\n", layer.name.c_str(), "-", "-", "-");
    if (inspection.stride > 1)
        std::printf("There are %zu lights, so only every %d-th pixel of every row and column was inspected.\n",
                    inspection.lights.size(), inspection.stride);
    std::printf("Wrote %s; index.html shows it.\n", folder.c_str());
    return 0;
}

}  // namespace ext::lab
