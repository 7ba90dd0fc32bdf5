#include "ext/lab/noise_by_depth.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "ext/lab/results.h"
#include "ext/lab/sampler_run.h"
#include "ext/lab/tile_statistics.h"
#include "pbrt/images/metrics.h"

namespace ext::lab {
namespace {

constexpr double kTrimmedShare = 0.001;

constexpr const char *kRareLight =
    "Images whose noise is mostly rare bright samples have more noise than this: few seeds contain few of them.";

/// Images of one sampler with path depths of at most `depth`; empty if cancelled.
std::vector<Image> Pictures(const ExperimentSettings &settings, const LabScene &scene, const SamplerChoice &choice,
                            int depth, Progress &progress) {
    std::vector<Image> pictures;
    for (int seed = 0; seed < settings.seeds; ++seed) {
        SamplerRun run(scene, choice, seed, settings.samplesPerPixel, progress, depth);
        if (!run.Prepare() || !run.RenderTo({settings.samplesPerPixel, 0})) return {};
        pictures.push_back(run.Picture().Select({"R", "G", "B"}));
        progress.Advance();
    }
    return pictures;
}

std::string Bars(const Json &json, const char *what) {
    constexpr double kWidth = 760, kHeight = 34, kLeft = 260;
    double largest = 0;
    for (const Json &s : json.at("samplers"))
        for (const Json &d : s.at("depths")) largest = std::max(largest, d.at(what).get<double>());
    std::string svg = fmt::format("<svg viewBox=\"0 0 {} {}\" role=\"img\">\n", kLeft + kWidth + 90,
                                  double(json.at("samplers").size()) * kHeight + 6);
    double y = 3;
    for (const Json &s : json.at("samplers")) {
        svg += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>\n", kLeft - 10, y + 20,
                           EscapeHtml(s.at("label")));
        double from = 0;
        int k = 0;
        const auto length = [&](double noise) { return largest > 0 ? noise / largest * kWidth : 0; };
        for (const Json &d : s.at("depths")) {
            const double to = std::max(from, d.at(what).get<double>());
            const double x = kLeft + length(from), width = length(to - from);
            svg += fmt::format(
                "<rect x=\"{:.1f}\" y=\"{}\" width=\"{:.1f}\" height=\"{}\" fill=\"hsl({} 60% {}%)\"><title>up to {} "
                "scattering events: {:.4g}</title></rect>\n",
                x, y, width, kHeight - 8, 215 - 25 * (k % 8), k % 2 ? 58 : 46, d.at("depth").get<int>(),
                d.at(what).get<double>());
            if (width > 22)
                svg += fmt::format("<text class=\"in\" x=\"{:.1f}\" y=\"{}\">{}</text>\n", x + 5, y + 18,
                                   d.at("depth").get<int>());
            from = to;
            ++k;
        }
        svg += fmt::format("<text x=\"{:.1f}\" y=\"{}\">{:.3g}</text>\n", kLeft + length(from) + 8, y + 20,
                           s.at("depths").back().at(what).get<double>());
        y += kHeight;
    }
    return svg + "</svg>\n";
}

std::string Page(const Json &json) {
    std::string page = std::string(kPageHead) + R"(<style>
:root { color-scheme: light dark; }
body { margin: 0 auto; max-width: 1160px; padding: 24px 28px; font: 15px/1.5 system-ui, "DejaVu Sans", sans-serif; }
h1 { font-size: 26px; margin: 0; } h2 { font-size: 18px; margin: 28px 0 8px; } svg { width: 100%; font-size: 13px; }
svg text { fill: currentColor; } svg text.in { fill: #fff; }
</style>
)";
    const std::string scene = EscapeHtml(json.at("scene"));
    page += fmt::format(
        "<title>{0} · noise per path depth</title>\n</head>\n<body>\n<h1>Noise per path depth: {0}</h1>\n", scene);
    page += fmt::format(
        "<p>Expected relL2 of an image of {} per pixel, by how many scattering events paths may have. A piece "
        "of a bar is what the vertex of that number adds (its light sample and the emission that a bounce from the "
        "previous vertex hits). oracle: optimal light selection, the bound for any choice of lights. {} each. {}</p>\n",
        CountText(json.at("samples").get<int>(), "sample"), CountText(json.at("seeds").get<int>(), "seed"), kRareLight);
    page += "<h2>All pixels</h2>\n" + Bars(json, "plain");
    page += "<h2>Trimmed: without the noisiest 0.1 % of the pixels</h2>\n" + Bars(json, "trimmed");
    return page + "</body>\n</html>\n";
}

}  // namespace

Noise NoiseOf(std::span<const Image> pictures, const Image &reference) {
    const auto n = double(pictures.size());
    const int channels = reference.ChannelCount();
    const double epsilon = RelL2Epsilon(reference);
    std::vector<double> terms;
    ForEachPixel(reference.Resolution(), [&](int x, int y) {
        double term = 0;
        for (int c = 0; c < channels; ++c) {
            double sum = 0, squares = 0;
            for (const Image &p : pictures) sum += double(p.Get({x, y}, c));
            for (const Image &p : pictures) squares += Sqr(double(p.Get({x, y}, c)) - sum / n);
            term += squares / (n - 1) / (Sqr(double(reference.Get({x, y}, c))) + epsilon) / channels;
        }
        terms.push_back(term);
    });
    std::sort(terms.begin(), terms.end());
    const auto mean = [&](size_t kept) {
        const double sum = std::accumulate(terms.begin(), terms.begin() + kept, 0.0);
        return kept ? sum / double(kept) : 0;
    };
    return {mean(terms.size()), mean(terms.size() - size_t(std::ceil(kTrimmedShare * double(terms.size()))))};
}

std::vector<int> NoiseDepths(int maxDepth) {
    std::vector<int> depths;
    const auto next = [](int d) { return d < 4 ? d + 1 : std::has_single_bit(unsigned(d)) ? d / 2 * 3 : d / 3 * 4; };
    for (int d = 1; d < maxDepth; d = next(d)) depths.push_back(d);
    depths.push_back(std::max(maxDepth, 1));
    return depths;
}

int RunNoise(const ExperimentSettings &settings, const PluginRegistry &registry, Progress &progress) {
    if (settings.seeds < 2) throw UserError("--seeds: a variance takes at least two.");
    const std::vector<SamplerChoice> &choices = settings.samplers;
    const LabScene scene = LoadLabScene(settings, registry, progress);
    const std::vector<int> depths = NoiseDepths(scene.built.maxDepth);
    MakeFolder(settings.outFolder);  // an error comes before the renders

    progress.BeginPhase("rendering", choices.size() * depths.size() * settings.seeds);
    // The deepest come first: their mean is the reference of all others, which need not be stored.
    std::vector<Image> deepest;
    for (const SamplerChoice &choice : choices) {
        const std::vector<Image> pictures = Pictures(settings, scene, choice, depths.back(), progress);
        if (pictures.empty()) return 130;
        deepest.insert(deepest.end(), pictures.begin(), pictures.end());
    }
    const Image reference = AverageImages(deepest).image;
    const size_t seeds = settings.seeds;
    std::vector<std::vector<Noise>> noise(choices.size());
    for (size_t i = 0; i < choices.size(); ++i) {
        for (size_t d = 0; d + 1 < depths.size(); ++d) {
            const std::vector<Image> pictures = Pictures(settings, scene, choices[i], depths[d], progress);
            if (pictures.empty()) return 130;
            noise[i].push_back(NoiseOf(pictures, reference));
        }
        noise[i].push_back(NoiseOf(std::span(deepest).subspan(i * seeds, seeds), reference));
    }
    progress.EndPhase();

    Json json = {{"scene", settings.scene},
                 {"commandLine", settings.commandLine},
                 {"samples", settings.samplesPerPixel},
                 {"seeds", settings.seeds},
                 {"samplers", Json::array()}};
    std::printf("%-36s", "scattering events");
    for (const int depth : depths) std::printf(" %9d", depth);
    for (size_t i = 0; i < choices.size(); ++i) {
        Json entry{{"label", choices[i].label}, {"depths", Json::array()}};
        std::string trimmed;
        std::printf("\n%-36s", choices[i].label.c_str());
        for (size_t d = 0; d < depths.size(); ++d) {
            const auto &[plain, without] = noise[i][d];
            entry["depths"].push_back({{"depth", depths[d]}, {"plain", plain}, {"trimmed", without}});
            std::printf(" %9.4g", plain);
            trimmed += fmt::format(" {:>9.4g}", without);
        }
        std::printf("\n%-36s%s", "  trimmed", trimmed.c_str());
        json["samplers"].push_back(entry);
    }
    ShortenFloats(&json);
    WriteFile(settings.outFolder + "/noise.json", json.dump(2) + "\n");
    WriteFile(settings.outFolder + "/index.html", Page(json));
    std::printf("\n%s\nWrote %s; index.html shows it.\n", kRareLight, settings.outFolder.c_str());
    return 0;
}

}  // namespace ext::lab
