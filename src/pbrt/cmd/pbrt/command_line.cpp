#include "pbrt/cmd/pbrt/command_line.h"

#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include "pbrt/cmd/flags.h"
#include "pbrt/cmd/pbrt/live_view.h"
#include "pbrt/films/aov_film.h"

namespace pbrt {
namespace {

bool IsNumber(std::string_view text) { return !text.empty() && text.find_first_not_of("0123456789") == text.npos; }

/// The arguments with flags in the declared spelling, and the port joined to --serve.
std::vector<std::string> CanonicalArguments(const CLI::App &app, int argc, const char *const *argv) {
    std::vector<std::string> arguments;
    for (int i = 1; i < argc; ++i) {
        std::string argument = CanonicalFlag(app, argv[i]);
        // The port is optional, so CLI11 would parse it as a scene name.
        if (argument == "--serve" && i + 1 < argc && IsNumber(argv[i + 1])) argument += std::string("=") + argv[++i];
        arguments.push_back(argument);
    }
    return arguments;
}

/// "16:32".
std::pair<int, int> ParseSamples(const std::string &text) {
    const size_t colon = text.find(':');
    std::string low = text.substr(0, colon), high = colon == std::string::npos ? "" : text.substr(colon + 1);
    int first = -1, end = -1;
    if (!ReadNumber(low, first) || !ReadNumber(high, end) || first < 0 || end <= first)
        throw CLI::ValidationError(
            "--samples",
            "\"" + text + "\" is no range of samples; 0:16 and 16:32 are the first sixteen and the next sixteen");
    return {first, end};
}

/// CLI11's value of a flag without value.
constexpr const char *kNoValue = "true";

/// "text" or "json".
std::string ParseStats(const std::string &text) {
    if (text == kNoValue) return "text";
    if (text == "text" || text == "json") return text;
    throw CLI::ValidationError("--stats", "\"" + text + "\" is unknown; valid: text, json");
}

/// Port of --serve; -1: the default.
int ParsePort(const std::string &text) {
    if (text == kNoValue) return -1;
    if (!IsNumber(text) || text.size() > 5 || std::stoi(text) > 65535)
        throw CLI::ValidationError("--serve", "\"" + text + "\" is no port; 1 to 65535, or 0 for a free one");
    return std::stoi(text);
}

void CheckCombinations(const CLI::App &app) {
    using enum FlagRule::Kind;
    const char *part = "each is the part of the image to render";
    CheckRules(app, {{"--cropwindow", Excludes, "--pixelbounds", part},
                     {"--cropwindow", Excludes, "--pixel", part},
                     {"--pixelbounds", Excludes, "--pixel", part},
                     {"--mse-reference-image", Needs, "--mse-reference-out", "the file for the errors"},
                     {"--mse-reference-out", Needs, "--mse-reference-image", "the image to compare with"},
                     {"--resume", Needs, "--checkpoint", "the file to resume from"},
                     {"--checkpoint-interval", Needs, "--checkpoint", "the file to write at this interval"},
                     {"--samples", Needs, "--checkpoint", "the file for the samples"},
                     {"--samples", Excludes, "--time", "parts have the samples of --spp"},
                     {"--samples", Excludes, "--adaptive", "parts take the same samples of all pixels"},
                     {"--samples", Excludes, "--noise", "parts take the same samples of all pixels"},
                     {"--samples", Excludes, "--write-partial-images", "a part makes no image"},
                     {"--samples", Excludes, "--save-lights", "a part lacks samples"}});
}

FlagHints StockFlags() {
    FlagHints hints;
    const auto add = [&](std::initializer_list<const char *> flags, const char *hint) {
        for (const char *flag : flags) hints[flag] = hint;
    };
    add({"gpu", "gpudevice", "wavefront"}, "this program renders on the CPU only; leave the flag out");
    add({"interactive", "fullscreen"},
        "this program opens no window; --serve and --display-server show the image as it grows");
    add({"loglevel", "logfile", "logutilization"},
        "this program writes no log; --quiet prints errors only, --stats statistics");
    add({"upgrade", "format", "toply"},
        "this program only renders; the pbrt of pbrt-v4 converts scene files with this flag");
    add({"pixelmaterial", "pixelstats", "debugstart", "disableimagetextures"},
        "this program has nothing like it; leave the flag out");
    add({"shadowgate"}, "it was removed (docs/develop/negative-results.md); leave the flag out");
    return hints;
}

struct RawFlags {
    std::vector<Float> crop;
    std::vector<int> bounds, pixel;
    std::string samples, port;
    double memoryLimitMb = 0;
};

/// Lines of the help text.
std::string LightSamplerExamples(const PluginRegistry &registry) {
    std::string text = "  pbrt --lightsampler bvh+mesh --spp 64 --outfile out.exr scene.pbrt\n";
    for (const std::string &name : registry.samplers.Names())
        if (const char *example = registry.samplers.Find(name).traits.example)
            text += fmt::format("  pbrt --lightsampler {}:{} scene.pbrt\n", name, example);
    if (!registry.directionSamplings.Names().empty()) text += "  pbrt --lightsampler bvh+mesh+guide scene.pbrt\n";
    return text;
}

void AddAllFlags(CLI::App &app, const PluginRegistry &registry, CommandLine &o, RawFlags &raw) {
    BuildOptions &build = o.build;
    app.add_option("scene", o.sceneFiles,
                   "scene files, parsed one after the other as one scene; none or \"-\": standard input");
    AddFlags(
        app, "Image",
        {Flag("--cropwindow", raw.crop, "render only x0,x1,y0,y1, as fractions of the image")
             .Count(4)
             .Type("x0,x1,y0,y1"),
         Flag("--pixelbounds", raw.bounds, "render only x0,x1,y0,y1, in pixels").Count(4).Type("x0,x1,y0,y1"),
         Flag("--pixel", raw.pixel, "render only the pixel x,y", ValidRange{0, kMaxImageSide}).Count(2).Type("x,y"),
         {"--outfile", build.film.filename, "image to write (.exr, .png, .pfm); overrides the scene's film filename"},
         Flag("--aov", build.film.aovs,
              fmt::format(
                  "auxiliary channels, mostly of the first visible surface, added to the image of any film, separated "
                  "by commas: {}; denoisers read these names",
                  fmt::join(AovNames(), ", ")),
              OneOf(AovNames()))
             .Type("NAME,..."),
         {"--write-partial-images", o.writePartialImages, "write the image after every wave of samples"},
         {"--mse-reference-image", build.mseReferenceImage, "compare with this image after every wave"},
         {"--mse-reference-out", build.mseReferenceOut, "file for the \"spp, mse\" lines of that comparison"}});
    const char *watching = "Watching";
    AddFlags(app, watching,
             {{"--display-server", o.displayServer,
               "HOST:PORT of a viewer with tev's protocol (tev uses localhost:14158): shows the image as it grows"}});
    app.add_flag("--serve", raw.port,
                 "page for a browser on this machine: the image as it grows, its error so far, time left; --serve "
                 "PORT or --serve=PORT, 0: any free port")
        ->group(watching);

    AddFlags(
        app, "Effort",
        {{"--spp", build.samplesPerPixel, "samples per pixel; overrides the scene's sampler", PositiveNumber},
         {"--time", o.timeBudget,
          "render for this many seconds, preprocessing included; overrides --spp. A short measurement estimates the "
          "number of samples, for which everything is prepared",
          PositiveNumber},
         {"--adaptive", build.adaptive,
          "more samples where the image is noisier; --spp samples per pixel on average (all integrators but lightpath, "
          "mlt and sppm)"},
         {"--noise", o.noise,
          "--adaptive until the estimated noise of the image is at most this: 0.05 is fine grain, 0.01 is hardly "
          "visible. It is the square root of relL2 (imgtool diff). --spp or --time is the limit",
          PositiveNumber},
         {"--seed", build.seed, "seed of the pixel sampler (0)"},
         {"--nthreads", o.threads, "threads (0: all cores)", NonNegativeNumber},
         {"--memory-limit", raw.memoryLimitMb,
          "megabytes of memory that may be used; a scene with a larger estimate ends with an error before it is built",
          PositiveNumber},
         {"--quick", build.quick, "a quarter of the resolution, one sample per pixel unless --spp is given"},
         {"--texture-cache-mb", build.textureCacheMb,
          "memory for image textures; the rest is kept in a temporary folder (0: all in memory)", NonNegativeNumber}});

    AddFlags(
        app, "Long renders and many machines",
        {{"--checkpoint", o.checkpoint,
          "file that keeps all of the render, for --resume and for imgtool merge: written every "
          "--checkpoint-interval seconds, at the end and on Ctrl-C"},
         {"--checkpoint-interval", o.checkpointInterval,
          "seconds between checkpoints (60), at least as long as one sample of every pixel takes", PositiveNumber},
         {"--resume", o.resume,
          "resume from the --checkpoint file, if it exists; the result is bit-identical to an uninterrupted render. A "
          "larger --spp or --time than before continues the render"},
         {"--samples", raw.samples,
          "FIRST:END: render only these samples of every pixel, from FIRST up to END - 1, into the --checkpoint file, "
          "without an image; imgtool merge makes the image from all parts"},
         {"--save-lights", o.saveLights,
          "file for the records of the light sampler and the path guide at the end of the render"},
         {"--load-lights", o.loadLights,
          "choose lights and guide paths by the records of another render, without learning: for parts of one image, "
          "and frames of an animation with static lights; like --save-lights, renders in world coordinates"}});

    const char *lights = "Light selection";
    AddFlags(app, lights,
             {{"--lightsampler", build.lightSampler,
               "method that chooses the light for a shadow ray, see below; overrides the scene"},
              {"--mesh-lights", build.meshLights, "the same as +mesh: an emissive mesh is one light"},
              {"--shooting-sampler", build.shootingSampler,
               fmt::format("name[:key=value,...] of the light sampler that chooses where light paths begin (bdpt, mlt, "
                           "lightpath, sppm): {}; overrides the scene",
                           fmt::join(registry.EmissionSamplerNames(), ", "))}});
    app.add_flag_callback(
           "--list-lightsamplers", [&o] { o.list = "lightsamplers"; }, "the same as --list lightsamplers")
        ->group(lights);

    AddFlags(app, "Method",
             {{"--integrator", build.integrator, "use this integrator instead of the scene's (path, simplepath, ...)"},
              {"--guide", build.guide,
               "integrators path, volpath: learned Russian roulette and path guiding (\"guide.*\" parameters)"},
              {"--maxdepth", build.maxDepth, "scattering events per path; 1: direct light only", NonNegativeNumber},
              {"--disable-pixel-jitter", build.disablePixelJitter, "sample pixel centres only"},
              {"--disable-wavelength-jitter", build.disableWavelengthJitter, "the same wavelengths for every sample"},
              {"--disable-texture-filtering", build.disableTextureFiltering, "point-sample all textures"},
              {"--force-diffuse", build.forceDiffuse, "make every surface diffuse, with its own reflectance"},
              {"--displacement-edge-scale", build.displacementEdgeScale,
               "multiplies the \"edgelength\" of displaced meshes", PositiveNumber},
              {"--ignore-media", build.ignoreMedia, "leave out media; the image is called ...-without-media"},
              {"--ignore-unsupported", build.ignoreUnsupported,
               "leave out unsupported features; the image is called ...-incomplete"},
              {"--render-coord-sys", build.renderCoordSys, "camera, cameraworld (default) or world",
               OneOf({"camera", "cameraworld", "world"})}});

    const char *messages = "Messages";
    AddFlags(app, messages,
             {{"--list", o.list,
               "print what a scene can name, with all parameters, and stop: cameras, films, filters, samplers, "
               "integrators, accelerators, shapes, materials, floattextures, spectrumtextures, lights, arealights, "
               "media, lightsamplers; as Markdown all, table, lightsamplertables"},
              {"--quiet", o.quiet, "no progress and no warnings; errors only"}});
    app.add_flag("--stats", o.stats,
                 "print statistics to standard output after rendering; --stats=json: as a JSON object, for scripts")
        ->group(messages);
}

}  // namespace

std::optional<int> ParseCommandLine(int argc, const char *const *argv, const PluginRegistry &registry,
                                    CommandLine *options) {
    CommandLine &o = *options;
    o.text = JoinArguments(argc, argv);

    CLI::App app(
        fmt::format(
            "Renders pbrt-v4 scene files. An independent renderer compatible with pbrt-v4 scenes, made for\n"
            "choosing the right light at every shading point.\n\n"
            "  pbrt scene.pbrt                              with the settings of the scene\n"
            "  pbrt --quick --spp 16 scene.pbrt             a small image, quickly\n"
            "{}\n"
            "Ctrl-C, SIGTERM and SIGHUP save what was rendered and end with status 130, 143 and 129; a second\n"
            "one ends at once. A file that holds more samples of the same scene is kept: the interrupted image\n"
            "is then written beside it, as out-unfinished.exr.",
            LightSamplerExamples(registry)),
        "pbrt");
    app.footer(
        "A light sampler is written name[:key=value,...][+mesh][+guide[:key=value,...]]: +mesh takes every emissive\n"
        "mesh as one light, +guide is --guide with parameters, guide.key in a scene. --list-lightsamplers names all\n"
        "samplers with their parameters.");
    app.set_version_flag("--version", VersionText(), "print the version, and stop");
    RawFlags raw;
    AddAllFlags(app, registry, o, raw);

    const std::optional<int> status = ParseFlags(app, CanonicalArguments(app, argc, argv), StockFlags(), [&] {
        CheckCombinations(app);
        if (!raw.samples.empty()) o.samples = ParseSamples(raw.samples);
        if (!o.displayServer.empty() && SplitServer(o.displayServer).first.empty())
            throw CLI::ValidationError(
                "--display-server",
                "\"" + o.displayServer + "\" is no HOST:PORT, such as localhost:14158, where tev listens");
        if (app.count("--serve")) o.servePort = ParsePort(raw.port);
        if (app.count("--stats")) o.stats = ParseStats(o.stats);
    });
    if (status) return status;
    if (o.sceneFiles.empty()) o.sceneFiles = {"-"};
    o.build.adaptive = o.build.adaptive || o.noise > 0;
    o.memoryLimit = 1e6 * raw.memoryLimitMb;
    for (const auto &[flag, path] : {std::pair("--checkpoint", &o.checkpoint), {"--save-lights", &o.saveLights}})
        if (!path->empty()) o.build.outputs.push_back({flag, *path});
    if (!o.loadLights.empty()) o.build.inputs.push_back({"--load-lights", o.loadLights});
    // A part writes no image.
    o.build.checksOutput = !o.samples;
    const auto &[crop, bounds, pixel, samples, port, limit] = raw;
    if (!crop.empty()) o.build.film.cropWindow = Bounds2{{crop[0], crop[2]}, {crop[1], crop[3]}};
    if (!bounds.empty()) o.build.film.pixelBounds = Bounds2i{{bounds[0], bounds[2]}, {bounds[1], bounds[3]}};
    if (!pixel.empty()) o.build.film.pixelBounds = Bounds2i{{pixel[0], pixel[1]}, {pixel[0] + 1, pixel[1] + 1}};
    return {};
}

}  // namespace pbrt
