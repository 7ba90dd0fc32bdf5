#include "ext/lab/lightlab/command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "ext/lab/reference_cache.h"
#include "pbrt/build/light_sampler_spec.h"
#include "pbrt/cmd/flag_checks.h"
#include "pbrt/cmd/number_checks.h"
#include "pbrt/core/version.h"

namespace pbrt {

namespace {

const char *const kAbout =
    "Which light sampler gives the least error in the same time, on this scene? Renders the scene with each of\n"
    "several light samplers, measures them against a reference, checks them for bias, and writes tables, pictures,\n"
    "charts and one page, report.html, into a folder.\n\n"
    "  lightlab scene.pbrt --time 20                    20 s for every sampler and seed, preparation included\n"
    "  lightlab scene.pbrt --spp 64 --seeds 5           64 samples per pixel for every sampler and seed\n"
    "  lightlab a.pbrt b.pbrt c.pbrt --time 20          one table over several scenes, and a page that links them\n"
    "  lightlab scene.pbrt --samplers bvh,octree,octree:budget=0.02,floor=0.2,bvh+mesh,octree+guide\n"
    "  lightlab inspect scene.pbrt --sampler octree     pictures of what a sampler knows (see lightlab inspect "
    "--help)\n"
    "  lightlab noise scene.pbrt                        which vertices of paths bring the noise (see lightlab noise "
    "--help)\n\n"
    "Ctrl-C keeps what is finished; the same command goes on from there, with more --seeds as well.";

const char *const kFooter =
    ", as in\n"
    "pbrt: +mesh takes every emissive mesh as one light, +guide lets paths learn where they should end and go. pbrt\n"
    "--list-lightsamplers names all with their parameters. Commas or semicolons separate samplers; a comma before\n"
    "key=value continues the same sampler.\n\n"
    "The reference is rendered with the sampler that has the least variance in a short pilot run. If that sampler is\n"
    "compared, a second reference, rendered with the next best, judges it. References are kept in the cache folder as\n"
    "<scene>.reference-<hash>.exr; the hash changes with anything the scene says. A reference takes\n"
    "16 n samples for --spp n, at least 512, and about 10 t seconds for --time t.\n\n"
    "Environment: LIGHTLAB_REPORT_SCRIPTS, the folder of charts.py and report.py; LIGHTLAB_PYTHON (/usr/bin/python3).";

struct Parser {
    CLI::App app;
    LightlabCommandLine result;

    explicit Parser(const std::string &about, const std::string &name) : app(about, name) {}
    /// False: help or an error was printed.
    template <class AfterParse>
    bool Parse(int argc, const char *const *argv, AfterParse &&afterParse) {
        std::vector<std::string> arguments(argv, argv + argc);
        try {
            CheckFlags(app, arguments,
                       {{"lightsampler",
                         "--samplers lists the light samplers to compare; in lightlab inspect, "
                         "--sampler names one"},
                        {"outfile", "--out names the folder of all that is written"}});
            std::reverse(arguments.begin(), arguments.end());  // CLI11 takes them from the back
            app.parse(arguments);
            afterParse();
            return true;
        } catch (const CLI::CallForHelp &) {
            std::cout << app.help();
        } catch (const CLI::CallForVersion &) {
            std::cout << VersionText() << "\n";
        } catch (const CLI::ParseError &e) {
            std::cerr << "Error: " << e.what() << "\nRun with --help for all options.\n";
            result.status = 1;
        }
        result.done = true;
        return false;
    }
};

std::string Text(int argc, const char *const *argv) {
    std::string text;
    for (int i = 0; i < argc; ++i) text += (i ? " " : "") + std::string(argv[i]);
    return text;
}

/// The samplers of the paper's comparison that this build has.
std::string DefaultSamplers(const std::vector<std::string> &registered) {
    std::string list;
    for (const char *name : {"uniform", "power", "bvh", "spatial", "neepp", "octree"})
        if (std::find(registered.begin(), registered.end(), name) != registered.end())
            list += (list.empty() ? "" : ",") + std::string(name);
    return list;
}

LightlabCommandLine ParseInspect(int argc, const char *const *argv) {
    Parser parser(
        "Writes pictures of what a light sampler knows at the surfaces that the camera sees first: cell and records,\n"
        "entropy of the distribution, which light contributes most and its probability, measured visibility.\n\n"
        "  lightlab inspect scene.pbrt --sampler octree --out DIR",
        "lightlab inspect");
    LightlabOptions &o = parser.result.options;
    lab::InspectOptions &inspect = o.inspect.emplace();
    int maxDepth = 0, seed = 0;
    CLI::App &app = parser.app;
    app.add_option("scene", inspect.sceneFiles, "scene file")->required();
    inspect.build.lightSamplerFlag = "--sampler";
    app.add_option("--sampler", inspect.build.lightSampler,
                   std::string(kLightChoiceSyntax) + "; the scene's if left out");
    app.add_flag("--mesh", inspect.build.meshLights, "the same as +mesh: an emissive mesh is one light");
    app.add_option("--out", inspect.outFolder, "folder (inspect-<sampler>)");
    app.add_option("--divisor", inspect.build.film.resolutionDivisor, "divides the resolution")->check(PositiveNumber);
    CLI::Option *depth =
        app.add_option("--maxdepth", maxDepth, "scattering events per path (the scene's)")->check(NonNegativeNumber);
    CLI::Option *seedOption = app.add_option("--seed", seed, "seed of the preparation");
    app.add_option("--samples", inspect.settings.samples, "light samples per light and pixel (32)")
        ->check(PositiveNumber);
    app.add_option("--lights", inspect.settings.shownLights, "number of lights whose measured visibility is shown (16)")
        ->check(NonNegativeNumber);
    app.add_option("--nthreads", o.threads, "threads (0: all cores)")->check(NonNegativeNumber);
    app.add_flag("--quiet", o.quiet, "no progress and no warnings");
    parser.Parse(argc - 2, argv + 2, [] {});
    if (*depth) inspect.build.maxDepth = maxDepth;
    if (*seedOption) inspect.build.seed = seed;
    inspect.commandLine = Text(argc, argv);
    return parser.result;
}

LightlabCommandLine ParseNoise(int argc, const char *const *argv, const std::vector<std::string> &registered) {
    Parser parser(
        "Where is the noise? Renders the scene with paths of at most 1, 2, 3, ... scattering events, and tells how "
        "much\n"
        "noise each vertex of the paths adds, with each of several light samplers, with and without a guide.\n"
        "The sampler oracle shows the bound: what is left if lights are chosen perfectly (slow where there are "
        "many).\n\n"
        "  lightlab noise scene.pbrt --samplers octree,octree+guide,oracle --divisor 4 --out DIR",
        "lightlab noise");
    LightlabOptions &o = parser.result.options;
    lab::NoiseOptions &noise = o.noise.emplace();
    lab::CampaignSettings &c = noise.campaign;
    c.samplesPerPixel = 32;
    c.seeds = 6;
    c.commandLine = Text(argc, argv);
    const bool hasOctree = std::find(registered.begin(), registered.end(), "octree") != registered.end();
    std::string samplers = hasOctree ? "octree,octree+guide" : "bvh,bvh+guide";
    int maxDepth = 0;
    CLI::App &app = parser.app;
    app.add_option("scene", c.scene, "scene file")->required();
    app.add_option("--samplers", samplers, "list of samplers (" + samplers + ")");
    app.add_option("--spp", c.samplesPerPixel, "samples per pixel (32)")->check(PositiveNumber);
    app.add_option("--seeds", c.seeds, "independent pictures of each kind, from which the variance is told (6)")
        ->check(CLI::Range(2, 1000));
    app.add_option("--divisor", c.resolutionDivisor, "divides the resolution (1)")->check(PositiveNumber);
    CLI::Option *depth =
        app.add_option("--maxdepth", maxDepth, "scattering events per path (the scene's)")->check(PositiveNumber);
    app.add_option("--out", c.outFolder, "folder (<scene name>-noise)");
    app.add_option("--nthreads", o.threads, "threads (0: all cores)")->check(NonNegativeNumber);
    app.add_flag("--quiet", o.quiet, "no progress and no warnings");
    parser.Parse(argc - 2, argv + 2, [] {});
    if (*depth) c.maxDepth = maxDepth;
    if (c.outFolder.empty()) c.outFolder = std::filesystem::path(c.scene).stem().string() + "-noise";
    noise.samplers = lab::SplitSamplerList(samplers);
    return parser.result;
}

/// Takes the settings that the command line does not give from the campaign that is replayed.
void TakeFromResults(LightlabOptions *o, bool samplers, bool seeds, bool depth, bool sampledLight, bool divisor,
                     bool spp) {
    lab::CampaignSettings &c = o->campaign;
    const nlohmann::ordered_json results = lab::ReadResults(c.samplesFrom);
    const nlohmann::ordered_json &settings = results.at("settings");
    if (results.value("mode", "") == "time")
        c.timeBudget = results.value("budget", 0.0);
    else if (!spp)
        c.samplesPerPixel = results.value("budget", c.samplesPerPixel);
    if (!samplers) o->samplers = settings.at("samplers").get<std::vector<std::string>>();
    if (!seeds) c.seeds = settings.value("seeds", c.seeds);
    if (!depth && settings.at("maxdepth").is_number()) c.maxDepth = settings.at("maxdepth").get<int>();
    if (!sampledLight) c.sampledLightOnly = settings.value("sampled-light", false);
    if (!divisor) c.resolutionDivisor = settings.value("divisor", 1);
    if (c.referenceFile.empty() && c.referenceSamples == 0) {
        c.referenceFile = settings.value("reference", "");
        c.referenceSamples = settings.value("reference-spp", 0);
    }
}

}  // namespace

std::vector<Bounds2i> ParseCrops(const std::string &text) {
    std::vector<Bounds2i> crops;
    std::istringstream list(text);
    for (std::string piece; std::getline(list, piece, ';');) {
        int v[4];
        char comma[3], rest;
        std::istringstream in(piece);
        in >> v[0] >> comma[0] >> v[1] >> comma[1] >> v[2] >> comma[2] >> v[3];
        if (!in || std::string(comma, 3) != ",,," || in >> rest || v[2] <= v[0] || v[3] <= v[1])
            throw UserError(fmt::format("--crops: \"{}\" is not x0,y0,x1,y1 with x0 < x1 and y0 < y1.", piece));
        crops.push_back({{v[0], v[1]}, {v[2], v[3]}});
    }
    return crops;
}

LightlabCommandLine ParseLightlabCommandLine(int argc, const char *const *argv,
                                             const std::vector<std::string> &registered) {
    if (argc > 1 && std::string(argv[1]) == "inspect") return ParseInspect(argc, argv);
    if (argc > 1 && std::string(argv[1]) == "noise") return ParseNoise(argc, argv, registered);

    Parser parser(kAbout, "lightlab");
    LightlabOptions &o = parser.result.options;
    lab::CampaignSettings &c = o.campaign;
    c.commandLine = Text(argc, argv);
    std::string samplers, samplersFile, crops;
    int maxDepth = 5;
    bool direct = false, noReport = false;
    CLI::App &app = parser.app;
    app.footer(std::string("A sampler is written ") + kLightChoiceSyntax + kFooter);
    app.set_version_flag("--version", VersionText(), "print the version, and stop");
    app.add_option("scenes", o.scenes, "scene file; of several, each is compared by itself, and index.html shows all")
        ->required();

    const char *what = "What is compared";
    CLI::Option *samplersOption =
        app.add_option("--samplers", samplers, "list of samplers (" + DefaultSamplers(registered) + ")")->group(what);
    CLI::Option *fileOption =
        app.add_option("--samplers-file", samplersFile,
                       "file with one sampler per line and # comments; its samplers follow those of --samplers")
            ->group(what);

    const char *effort = "Effort";
    CLI::Option *time =
        app.add_option("--time", c.timeBudget, "seconds for every sampler and seed, preparation included")
            ->check(PositiveNumber)
            ->group(effort);
    CLI::Option *spp = app.add_option("--spp", c.samplesPerPixel, "samples per pixel for every sampler and seed (64)")
                           ->check(PositiveNumber)
                           ->group(effort);
    CLI::Option *seedsOption = app.add_option("--seeds", c.seeds, "independent runs of every sampler (3)")
                                   ->check(PositiveNumber)
                                   ->group(effort);
    app.add_option("--nthreads", o.threads, "threads (0: all cores)")->check(NonNegativeNumber)->group(effort);
    time->excludes(spp);

    const char *scene = "Scene";
    CLI::Option *depth = app.add_option("--maxdepth", maxDepth, "scattering events per path (the scene's)")
                             ->check(NonNegativeNumber)
                             ->group(scene);
    app.add_flag("--direct", direct, "direct light only: --maxdepth 1")->group(scene)->excludes(depth);
    CLI::Option *sampledLight =
        app.add_flag(
               "--sampled-light", c.sampledLightOnly,
               "leave out lamps that the camera or a mirror shows, and caustics: no choice of lights changes these")
            ->group(scene);
    CLI::Option *divisorOption = app.add_option("--divisor", c.resolutionDivisor, "divides the resolution (1)")
                                     ->check(PositiveNumber)
                                     ->group(scene);

    const char *reference = "Reference";
    CLI::Option *file =
        app.add_option("--reference", c.referenceFile, "picture to compare with instead of rendering one")
            ->group(reference);
    app.add_option("--reference-spp", c.referenceSamples, "samples per pixel of a rendered reference")
        ->check(PositiveNumber)
        ->group(reference)
        ->excludes(file);

    CLI::Option *cache =
        app.add_option("--cache", c.cacheFolder,
                       "folder that keeps rendered references for later campaigns ($XDG_CACHE_HOME/pbrt_octree or "
                       "~/.cache/pbrt_octree); \"\": the output folder")
            ->group(reference);

    app.add_option(
           "--selection-work", c.selectionWork,
           "most lights drawn for every sampler in the bias check of light selection at vertices of paths (1e8, "
           "some 10 to 50 s; 0: bias is looked for in pictures only)")
        ->check(NonNegativeNumber)
        ->group(effort);

    const char *output = "Output";
    app.add_option("--out", c.outFolder,
                   "folder (<scene name>-lab); of several scenes: holds a folder for each (scenes-lab)")
        ->group(output);
    app.add_option("--crops", crops, "parts shown enlarged, x0,y0,x1,y1;... in pixels (where samplers differ most)")
        ->group(output);
    app.add_flag("--restart", c.restart, "delete the records of a campaign in the folder and begin anew")
        ->group(output);
    app.add_option("--samples-from", c.samplesFrom,
                   "results.json: render the sample counts recorded there, so that a --time campaign gives the same "
                   "pictures again")
        ->group(output)
        ->excludes(time);
    app.add_flag("--no-report", noReport, "no pictures of what the samplers know, no charts and no report.html")
        ->group(output);
    app.add_flag("--quiet", o.quiet, "no progress and no warnings; results and errors only")->group(output);

    const auto checkScenes = [&] {
        if (o.scenes.size() < 2) return;
        for (const auto &[given, flag] : {std::pair{!c.referenceFile.empty(), "--reference"},
                                          {!c.samplesFrom.empty(), "--samples-from"},
                                          {!crops.empty(), "--crops"}})
            if (given)
                throw CLI::ValidationError(fmt::format("{} belongs to one scene; {} are given", flag, o.scenes.size()));
    };
    if (!parser.Parse(argc - 1, argv + 1, checkScenes)) return parser.result;
    c.scene = o.scenes[0];
    if (!*cache) c.cacheFolder = lab::UserCacheFolder();
    o.report = !noReport;
    c.views = o.report;
    if (*depth) c.maxDepth = maxDepth;
    if (direct) c.maxDepth = 1;
    c.crops = ParseCrops(crops);
    if (*samplersOption) o.samplers = lab::SplitSamplerList(samplers);
    if (*fileOption)
        for (const std::string &s : lab::ReadSamplerFile(samplersFile)) o.samplers.push_back(s);
    if (!c.samplesFrom.empty())
        TakeFromResults(&o, *samplersOption || *fileOption, bool(*seedsOption), c.maxDepth.has_value(),
                        bool(*sampledLight), bool(*divisorOption), bool(*spp));
    if (o.samplers.empty() && !*samplersOption) o.samplers = lab::SplitSamplerList(DefaultSamplers(registered));
    if (c.outFolder.empty() && o.scenes.size() > 1) c.outFolder = "scenes-lab";
    if (c.outFolder.empty()) c.outFolder = std::filesystem::path(c.scene).stem().string() + "-lab";
    return parser.result;
}

}  // namespace pbrt
