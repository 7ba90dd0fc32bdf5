#include "ext/lab/inspect.h"

#include <fmt/format.h>

#include <algorithm>

#include "ext/lab/text_output.h"

namespace ext::lab {

namespace {

constexpr size_t kMaxLights = 100;

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
    const std::string range =
        colours.is_object() ? fmt::format("colours from {} to {}; here {} to {}, mean {}",
                                          Number(colours.at("darkest")), Number(colours.at("brightest")),
                                          Number(layer.at("least")), Number(layer.at("most")), Number(layer.at("mean")))
                            : std::string("a colour for each");
    const std::string name = EscapeHtml(layer.at("name")), file = EscapeHtml(layer.at("file"));
    return fmt::format(
        "<figure id=\"{0}\"><a href=\"{1}\"><img src=\"{1}\" alt=\"{0}\"></a><figcaption><b>{0}</b>{2}; "
        "{3}.</figcaption>"
        "</figure>\n",
        name, file, EscapeHtml(layer.at("meaning")), range);
}

std::string FlatText(const Json &layers) {
    std::string same, unknown, text;
    for (const Json &layer : layers) {
        if (!layer.at("isFlat")) continue;
        const std::string name = layer.at("name");
        const std::string subject =
            layer.contains("light") ? "visibility of " + layer.at("light").get<std::string>() : name;
        if (!layer.contains("least")) unknown += (unknown.empty() ? "" : "; ") + subject;
        else if (name == "sampler.leaf") text += "One leaf covers everything visible. ";
        else if (name == "brightest")
            text += "One light contributes most everywhere: " + layer.value("light", name) + ". ";
        else same += (same.empty() ? "" : "; ") + subject + " " + Number(layer.at("least"));
    }
    if (!same.empty()) text += "The same everywhere: " + same + ". ";
    if (!unknown.empty()) text += "No value anywhere: " + unknown + ". ";
    return text.empty() ? "" : "<p id=\"flat\">" + EscapeHtml(text) + "</p>\n";
}

std::string LightRows(const Json &lights) {
    std::vector<const Json *> sorted;
    for (const Json &light : lights) sorted.push_back(&light);
    std::stable_sort(sorted.begin(), sorted.end(), [](const Json *a, const Json *b) {
        return a->at("power").get<double>() > b->at("power").get<double>();
    });
    std::string rows;
    for (size_t i = 0; i < std::min(sorted.size(), kMaxLights); ++i)
        rows += fmt::format("<tr><td>{}</td><td class=\"number\">{}</td><td class=\"number\">{}</td></tr>\n",
                            EscapeHtml(sorted[i]->at("label")), Number(sorted[i]->at("first")),
                            Number(sorted[i]->at("power")));
    return rows;
}

}  // namespace

std::string InspectPage(const Json &inspection, const std::string &structure) {
    const Json &layers = inspection.at("layers"), &lights = inspection.at("lights");
    const std::string sampler = EscapeHtml(inspection.value("sampler", "")),
                      scene = EscapeHtml(inspection.value("scene", Json::array()).dump());
    std::string page = std::string(kPageHead) + kHead;
    page += fmt::format("<title>{} · lightlab inspect</title>\n</head>\n<body>\n<h1>{}</h1>\n", sampler, sampler);
    page += fmt::format(
        "<p>State of the light sampler at the first visible surface that is not purely specular. Scene: "
        "{}. "
        "{}</p>\n",
        scene, EscapeHtml(inspection.value("note", "")));
    page += FlatText(layers) + "<div class=\"pictures\">\n";
    for (const Json &layer : layers)
        if (layer.at("file").is_string()) page += Figure(layer);
    page += fmt::format(
        "</div>\n<h2>Lights</h2>\n<p>{} lights or emissive meshes{}. \"first\" is the number that the pictures' names "
        "use.</p>\n",
        lights.size(), lights.size() > kMaxLights ? fmt::format("; the {} of most power", kMaxLights) : "");
    page += "<table id=\"lights\"><tr><th>place in the scene file</th><th>first</th><th>power</th></tr>\n" +
            LightRows(lights) + "</table>\n";
    page += "<h2>Structure</h2>\n<pre>" + EscapeHtml(structure.empty() ? "no learned structure" : structure) +
            "</pre>\n</body>\n</html>\n";
    return page;
}

}  // namespace ext::lab
