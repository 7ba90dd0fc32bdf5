#include "ext/lab/lightlab/lightlab.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <sstream>

#include "ext/lab/reference.h"
#include "pbrt/build/light_sampler_spec.h"
#include "pbrt/cmd/flags.h"

namespace ext::lab {
namespace {

const char *const kAbout =
    "Compares light samplers at equal time or equal samples. Renders the scene with each of several light samplers,\n"
    "measures them against a reference, checks them for bias, and writes tables, images, charts and one page,\n"
    "report.html, into a folder.\n\n"
    "  lightlab scene.pbrt --time 20                    20 s for every sampler and seed, preparation included\n"
    "  lightlab scene.pbrt --spp 64 --seeds 5           64 samples per pixel for every sampler and seed\n"
    "  lightlab a.pbrt b.pbrt c.pbrt --time 20          one table over several scenes, and a page that links them\n"
    "  lightlab scene.pbrt --samplers bvh,octree,octree:budget=0.02,floor=0.2,bvh+mesh,octree+guide\n"
    "  lightlab inspect scene.pbrt --sampler octree     the learned state of a sampler (see lightlab inspect --help)\n"
    "  lightlab noise scene.pbrt                        noise per path depth (see lightlab noise --help)\n\n"
    "Ctrl-C keeps finished work; rerun the command to resume, also with more --seeds.";

const char *const kFooter =
    ", as in\n"
    "pbrt: +mesh takes every emissive mesh as one light, +guide adds learned Russian roulette and path guiding.\n"
    "pbrt --list-lightsamplers lists all with their parameters. Commas or semicolons separate samplers; a comma "
    "before\n"
    "key=value continues the same sampler.\n\n"
    "The reference is rendered with the sampler that has the lowest variance in a short pilot run, with --time that in\n"
    "equal time. If it is compared, a second reference, rendered with the next best, judges it. References are kept in\n"
    "the cache folder as <scene>.reference-<hash>.exr; the hash covers the whole scene. A reference takes\n"
    "16 n samples for --spp n, at least 512, and about 10 t seconds for --time t.\n\n"
    "Environment: LIGHTLAB_REPORT_SCRIPTS, the folder of charts.py and report.py; LIGHTLAB_PYTHON (/usr/bin/python3).";

const FlagHints kHints = {
    {"lightsampler", "--samplers lists the light samplers to compare; in lightlab inspect, --sampler names one"},
    {"outfile", "--out names the folder of all that is written"}};

/// Samplers of the paper's comparison in this build.
std::string DefaultSamplers(const std::vector<std::string> &registered) {
    std::string list;
    for (const char *name : {"uniform", "power", "bvh", "spatial", "neepp", "octree"})
        if (std::ranges::count(registered, name) > 0) list += (list.empty() ? "" : ",") + std::string(name);
    return list;
}

std::optional<int> ParseInspect(int argc, const char *const *argv, LightlabOptions &o) {
    CLI::App app(
        "Visualises the state of a light sampler at the first visible surfaces: cell and records,\n"
        "entropy of the distribution, which light contributes most and its probability, measured visibility.\n\n"
        "  lightlab inspect scene.pbrt --sampler octree --out DIR",
        "lightlab inspect");
    InspectOptions &inspect = o.inspect.emplace();
    inspect.build.lightSamplerFlag = "--sampler";
    inspect.commandLine = JoinArguments(argc, argv);
    app.add_option("scene", inspect.sceneFiles, "scene file")->required();
    AddFlags(app, "Options",
             {{"--sampler", inspect.build.lightSampler, std::string(kLightChoiceSyntax) + "; the scene's if left out"},
              {"--mesh", inspect.build.meshLights, "the same as +mesh: an emissive mesh is one light"},
              {"--out", inspect.outFolder, "folder (inspect-<sampler>)"},
              {"--divisor", inspect.build.film.resolutionDivisor, "divides the resolution", PositiveNumber},
              {"--maxdepth", inspect.build.maxDepth, "scattering events per path (the scene's)", NonNegativeNumber},
              {"--seed", inspect.build.seed, "seed of the preparation"},
              {"--samples", inspect.settings.samples, "light samples per light and pixel (32)", PositiveNumber},
              {"--lights", inspect.settings.shownLights, "number of lights whose measured visibility is shown (16)",
               NonNegativeNumber},
              {"--nthreads", o.threads, "threads (0: all cores)", NonNegativeNumber},
              {"--quiet", o.quiet, "no progress and no warnings"}});
    return ParseFlags(app, {argv + 2, argv + argc}, kHints, [] {});
}

std::optional<int> ParseNoise(int argc, const char *const *argv, const std::vector<std::string> &registered,
                              LightlabOptions &o) {
    CLI::App app(
        "Noise per path depth. Renders the scene with paths of at most 1, 2, 3, ... scattering events, and reports "
        "how\nmuch noise each path vertex adds, for each of several light samplers, with and without a guide.\n"
        "The sampler oracle gives the bound of optimal light selection (slow with many lights).\n\n"
        "  lightlab noise scene.pbrt --samplers octree,octree+guide,oracle --divisor 4 --out DIR",
        "lightlab noise");
    ExperimentSettings &c = o.experiment;
    o.noise = true;
    c.samplesPerPixel = 32;
    c.seeds = 6;
    c.commandLine = JoinArguments(argc, argv);
    const bool hasOctree = std::ranges::count(registered, "octree") > 0;
    std::string samplers = hasOctree ? "octree,octree+guide" : "bvh,bvh+guide";
    app.add_option("scene", c.scene, "scene file")->required();
    AddFlags(app, "Options",
             {{"--samplers", samplers, "list of samplers (" + samplers + ")"},
              {"--spp", c.samplesPerPixel, "samples per pixel (32)", PositiveNumber},
              {"--seeds", c.seeds, "independent images of each kind, for the variance (6)", ValidRange{2, 1000}},
              {"--divisor", c.resolutionDivisor, "divides the resolution (1)", PositiveNumber},
              {"--maxdepth", c.maxDepth, "scattering events per path (the scene's)", PositiveNumber},
              {"--out", c.outFolder, "folder (<scene name>-noise)"},
              {"--nthreads", o.threads, "threads (0: all cores)", NonNegativeNumber},
              {"--quiet", o.quiet, "no progress and no warnings"}});
    const std::optional<int> status = ParseFlags(app, {argv + 2, argv + argc}, kHints, [] {});
    if (c.outFolder.empty()) c.outFolder = std::filesystem::path(c.scene).stem().string() + "-noise";
    o.samplers = SplitSamplerList(samplers);
    return status;
}

struct RawFlags {
    std::string samplers, samplersFile, crops;
    bool direct = false, noReport = false;
};

void AddAllFlags(CLI::App &app, LightlabOptions &o, RawFlags &raw, const std::vector<std::string> &registered) {
    ExperimentSettings &c = o.experiment;
    app.set_version_flag("--version", VersionText(), "print the version, and stop");
    app.add_option("scenes", o.scenes, "scene files; each is compared separately, and index.html shows all")
        ->required();
    AddFlags(app, "What is compared",
             {{"--samplers", raw.samplers, "list of samplers (" + DefaultSamplers(registered) + ")"},
              {"--samplers-file", raw.samplersFile,
               "file with one sampler per line and # comments; its samplers follow those of --samplers"}});
    AddFlags(
        app, "Effort",
        {{"--time", c.timeBudget, "seconds for every sampler and seed, preparation included", PositiveNumber},
         {"--spp", c.samplesPerPixel, "samples per pixel for every sampler and seed (64)", PositiveNumber},
         {"--seeds", c.seeds, "independent runs of every sampler (3)", PositiveNumber},
         {"--nthreads", o.threads, "threads (0: all cores)", NonNegativeNumber},
         {"--selection-work", c.selectionWork,
          "maximum lights drawn for every sampler in the bias check of light selection at vertices of paths (1e8, some "
          "10 to 50 s; 0: only images are checked)",
          NonNegativeNumber}});
    AddFlags(
        app, "Scene",
        {{"--maxdepth", c.maxDepth, "scattering events per path (the scene's)", NonNegativeNumber},
         {"--direct", raw.direct, "direct light only: --maxdepth 1"},
         {"--sampled-light", c.sampledLightOnly,
          "leave out lights seen directly or by specular reflection, and caustics, which no light sampler affects"},
         {"--divisor", c.resolutionDivisor, "divides the resolution (1)", PositiveNumber}});
    AddFlags(app, "Reference",
             {{"--reference", c.referenceFile, "image to compare with instead of rendering one"},
              {"--reference-spp", c.referenceSamples, "samples per pixel of a rendered reference", PositiveNumber},
              {"--cache", c.cacheFolder,
               "folder that keeps rendered references for later experiments ($XDG_CACHE_HOME/pbrt_octree or "
               "~/.cache/pbrt_octree); \"\": the output folder",
               CLI::Validator("")}});
    AddFlags(
        app, "Output",
        {{"--out", c.outFolder, "folder (<scene name>-lab); of several scenes: holds a folder for each (scenes-lab)"},
         {"--crops", raw.crops, "parts shown enlarged, x0,y0,x1,y1;... in pixels (where samplers differ most)"},
         {"--restart", c.restart, "delete the records in the folder and start again"},
         {"--samples-from", c.samplesFrom,
          "results.json: render the sample counts recorded there, so that a --time experiment gives the same images "
          "again"},
         {"--no-report", raw.noReport, "no inspection views, no charts and no report.html"},
         {"--quiet", o.quiet, "no progress and no warnings; results and errors only"}});
}

void CheckCombinations(const CLI::App &app) {
    using enum FlagRule::Kind;
    CheckRules(app, {{"--time", Excludes, "--spp", "samplers are compared at equal time or at equal samples"},
                     {"--direct", Excludes, "--maxdepth", "it is --maxdepth 1"},
                     {"--reference-spp", Excludes, "--reference", "a given image is not rendered"},
                     {"--cache", Excludes, "--reference", "the folder keeps rendered references"},
                     {"--samples-from", Excludes, "--time", "the file has the numbers of samples"},
                     {"--samples-from", Excludes, "--spp", "the file has the numbers of samples"}});
}

/// Takes settings missing from the command line from the replayed experiment.
void TakeFromResults(const CLI::App &app, LightlabOptions *o) {
    ExperimentSettings &c = o->experiment;
    const Json results = ReadResults(c.samplesFrom);
    const Json &settings = results.at("settings");
    if (results.value("mode", "") == "time") c.timeBudget = results.value("budget", 0.0);
    else c.samplesPerPixel = results.value("budget", c.samplesPerPixel);
    if (!app.count("--samplers") && !app.count("--samplers-file"))
        o->samplers = settings.at("samplers").get<std::vector<std::string>>();
    if (!app.count("--seeds")) c.seeds = settings.value("seeds", c.seeds);
    if (!c.maxDepth && settings.at("maxdepth").is_number()) c.maxDepth = settings.at("maxdepth").get<int>();
    if (!app.count("--sampled-light")) c.sampledLightOnly = settings.value("sampled-light", false);
    if (!app.count("--divisor")) c.resolutionDivisor = settings.value("divisor", 1);
    if (c.referenceFile.empty() && c.referenceSamples == 0) {
        c.referenceFile = settings.value("reference", "");
        c.referenceSamples = settings.value("reference-spp", 0);
    }
}

/// "x0,y0,x1,y1;..." in image pixels, half-open. Throws UserError.
std::vector<Bounds2i> ParseCrops(const std::string &text) {
    std::vector<Bounds2i> crops;
    std::istringstream list(text);
    for (std::string piece; std::getline(list, piece, ';');) {
        int v[4];
        char comma[3], rest;
        std::istringstream in(piece);
        in >> v[0] >> comma[0] >> v[1] >> comma[1] >> v[2] >> comma[2] >> v[3];
        if (!in || std::string(comma, 3) != ",,," || in >> rest || v[2] <= v[0] || v[3] <= v[1])
            throw UserError("--crops: \"{}\" is not x0,y0,x1,y1 with x0 < x1 and y0 < y1.", piece);
        crops.push_back({{v[0], v[1]}, {v[2], v[3]}});
    }
    return crops;
}

}  // namespace

std::optional<int> ParseLightlabCommandLine(int argc, const char *const *argv,
                                            const std::vector<std::string> &registered, LightlabOptions &o) {
    if (argc > 1 && std::string(argv[1]) == "inspect") return ParseInspect(argc, argv, o);
    if (argc > 1 && std::string(argv[1]) == "noise") return ParseNoise(argc, argv, registered, o);

    CLI::App app(kAbout, "lightlab");
    app.footer(std::string("A sampler is written ") + kLightChoiceSyntax + kFooter);
    ExperimentSettings &c = o.experiment;
    RawFlags raw;
    AddAllFlags(app, o, raw, registered);
    c.commandLine = JoinArguments(argc, argv);
    const auto check = [&] {
        CheckCombinations(app);
        if (o.scenes.size() < 2) return;
        for (const auto &[value, flag] :
             {std::pair(&c.referenceFile, "--reference"), {&c.samplesFrom, "--samples-from"}, {&raw.crops, "--crops"}})
            if (!value->empty())
                throw CLI::ValidationError(fmt::format("{} belongs to one scene; {} are given", flag, o.scenes.size()));
    };
    if (const std::optional<int> status = ParseFlags(app, {argv + 1, argv + argc}, kHints, check)) return status;
    c.scene = o.scenes[0];
    if (!app.count("--cache")) c.cacheFolder = UserCacheFolder();
    o.report = c.views = !raw.noReport;
    if (raw.direct) c.maxDepth = 1;
    c.crops = ParseCrops(raw.crops);
    if (app.count("--samplers")) o.samplers = SplitSamplerList(raw.samplers);
    if (app.count("--samplers-file"))
        for (const std::string &s : ReadSamplerFile(raw.samplersFile)) o.samplers.push_back(s);
    if (!c.samplesFrom.empty()) TakeFromResults(app, &o);
    if (o.samplers.empty() && !app.count("--samplers")) o.samplers = SplitSamplerList(DefaultSamplers(registered));
    if (c.outFolder.empty() && o.scenes.size() > 1) c.outFolder = "scenes-lab";
    if (c.outFolder.empty()) c.outFolder = std::filesystem::path(c.scene).stem().string() + "-lab";
    return {};
}

}  // namespace ext::lab
