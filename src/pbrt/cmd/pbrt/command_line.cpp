#include "pbrt/cmd/pbrt/command_line.h"

#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <iostream>
#include <map>

#include "pbrt/cmd/flag_checks.h"
#include "pbrt/cmd/number_checks.h"
#include "pbrt/cmd/pbrt/tev_display.h"
#include "pbrt/core/version.h"
#include "pbrt/films/aov_film.h"

namespace pbrt {

namespace {

/// Lower case without '-' and '_': how flag names are compared.
std::string Fold(const std::string &name) {
    std::string folded;
    for (char c : name)
        if (c != '-' && c != '_') folded += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return folded;
}

bool IsNumber(std::string_view text) {
    return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// Rewrites every flag to the spelling that CLI11 knows. Unknown flags stay as they are, and CLI11 reports them.
std::vector<std::string> CanonicalFlags(const CLI::App &app, int argc, const char *const *argv) {
    std::map<std::string, std::string> canonical;
    for (const CLI::Option *option : app.get_options())
        for (const std::string &name : option->get_lnames()) canonical[Fold(name)] = "--" + name;
    std::vector<std::string> arguments;
    for (int i = 1; i < argc; ++i) {
        std::string argument = argv[i];
        bool isFlag = argument.size() > 1 && argument[0] == '-' &&
                      (std::isalpha(static_cast<unsigned char>(argument[1])) || argument[1] == '-');
        if (isFlag) {
            size_t equals = argument.find('=');
            auto it = canonical.find(Fold(argument.substr(0, equals)));
            if (it != canonical.end())
                argument = it->second + (equals == std::string::npos ? "" : argument.substr(equals));
        }
        // The port may be left out, so CLI11 would take it for the name of a scene.
        if (argument == "--serve" && i + 1 < argc && IsNumber(argv[i + 1])) argument += std::string("=") + argv[++i];
        arguments.push_back(argument);
    }
    return arguments;
}

/// "16:32".
std::pair<int, int> ParseSamples(const std::string &text) {
    const size_t colon = text.find(':');
    int first = -1, end = -1;
    if (colon == std::string::npos || !CLI::detail::lexical_cast(text.substr(0, colon), first) ||
        !CLI::detail::lexical_cast(text.substr(colon + 1), end) || first < 0 || end <= first)
        throw CLI::ValidationError("--samples",
                                   "\"" + text +
                                       "\" is no range of samples; 0:16 and 16:32 are the first sixteen and "
                                       "the next sixteen");
    return {first, end};
}

/// What a flag without a value has instead of one.
constexpr const char *kNoValue = "true";

/// "text" or "json".
std::string ParseStats(const std::string &text) {
    if (text == kNoValue) return "text";
    if (text == "text" || text == "json") return text;
    throw CLI::ValidationError("--stats", "\"" + text + "\" is unknown; valid: text, json");
}

/// The port of --serve; -1: a usual one.
int ParsePort(const std::string &text) {
    if (text == kNoValue) return -1;
    if (!IsNumber(text) || text.size() > 5 || std::stoi(text) > 65535)
        throw CLI::ValidationError("--serve", "\"" + text + "\" is no port; 1 to 65535, or 0 for a free one");
    return std::stoi(text);
}

/// The rules for the flags of viewers.
void CheckViewers(const CommandLine &o) {
    if (!o.displayServer.empty() && SplitServer(o.displayServer).first.empty())
        throw CLI::ValidationError(
            "--display-server",
            "\"" + o.displayServer + "\" is no HOST:PORT, such as localhost:14158, where tev listens");
}

/// The rules for the flags that keep a render.
void CheckKeeping(const CommandLine &o) {
    const auto refuse = [](const char *message) { throw CLI::ValidationError(message); };
    if (o.resume && o.checkpoint.empty()) refuse("--resume goes on from the file that --checkpoint names");
    if (!o.samples) return;
    if (o.checkpoint.empty()) refuse("--samples writes its part to the file that --checkpoint names");
    if (o.timeBudget > 0) refuse("--samples and --time exclude each other");
    if (o.writePartialImages)
        refuse("--samples and --write-partial-images exclude each other: a part makes no picture");
    if (!o.saveLights.empty())
        refuse("--samples and --save-lights exclude each other: a part has not seen all samples");
}

template <class T>
CLI::Option *AddNumbers(CLI::App &app, const std::string &name, std::vector<T> &values, int count,
                        const std::string &form, const std::string &help) {
    return app.add_option(name, values, help)
        ->delimiter(',')
        ->expected(count)
        ->allow_extra_args(false)
        ->type_name(form);
}

/// Flags of stock pbrt-v4 that this program lacks.
FlagHints StockFlags() {
    const std::string cpu = "this program renders on the CPU only; leave the flag out",
                      window =
                          "this program opens no window; --serve and --display-server show the picture as it grows",
                      log = "this program writes no log; --quiet prints errors only, --stats statistics",
                      convert = "this program only renders; the pbrt of pbrt-v4 converts scene files with this flag",
                      none = "this program has nothing like it; leave the flag out";
    return {{"gpu", cpu},
            {"gpudevice", cpu},
            {"wavefront", cpu},
            {"interactive", window},
            {"fullscreen", window},
            {"loglevel", log},
            {"logfile", log},
            {"logutilization", log},
            {"upgrade", convert},
            {"format", convert},
            {"toply", convert},
            {"pixelmaterial", none},
            {"pixelstats", none},
            {"debugstart", none},
            {"disableimagetextures", none}};
}

}  // namespace

CommandLineResult ParseCommandLine(int argc, const char *const *argv) {
    CommandLineResult result;
    CommandLine &o = result.options;
    for (int i = 0; i < argc; ++i) o.text += (i ? " " : "") + std::string(argv[i]);

    CLI::App app(
        "Renders pbrt-v4 scene files. An independent renderer compatible with pbrt-v4 scenes, made for\n"
        "choosing the right light at every shading point.\n\n"
        "  pbrt scene.pbrt                              as the scene says\n"
        "  pbrt --lightsampler octree scene.pbrt        lights chosen by the visibility octree\n"
        "  pbrt --lightsampler octree:budget=0.02,floor=0.1 --spp 64 --outfile out.exr scene.pbrt\n"
        "  pbrt --lightsampler bvh+mesh+guide scene.pbrt\n"
        "  pbrt --quick --spp 16 scene.pbrt             a small picture, quickly\n\n"
        "Ctrl-C, SIGTERM and SIGHUP save what was rendered and end with status 130, 143 and 129; a second one ends\n"
        "at once. A file that holds more samples of the same scene is kept: the interrupted picture is then\n"
        "written beside it, as out-unfinished.exr.",
        "pbrt");
    app.footer(
        "A light sampler is written name[:key=value,...][+mesh][+guide[:key=value,...]], here, in lightlab and in\n"
        "lightlab inspect: +mesh takes every emissive mesh as one light, +guide is --guide with parameters, guide.key\n"
        "in a scene. --list-lightsamplers names all samplers with their parameters.");
    app.set_version_flag("--version", VersionText(), "print the version, and stop");
    std::vector<Float> crop;
    std::vector<int> bounds, pixel;
    int spp = 0, seed = 0, maxDepth = 0;
    std::string samples, port;
    double memoryLimitMb = 0;
    app.add_option("scene", o.sceneFiles,
                   "scene files, parsed one after the other as one scene; none or \"-\": standard input");

    const char *image = "Image";
    AddNumbers(app, "--cropwindow", crop, 4, "x0,x1,y0,y1", "render only x0,x1,y0,y1, as fractions of the image")
        ->group(image);
    AddNumbers(app, "--pixelbounds", bounds, 4, "x0,x1,y0,y1", "render only x0,x1,y0,y1, in pixels")->group(image);
    AddNumbers(app, "--pixel", pixel, 2, "x,y", "render only the pixel x,y")->group(image);
    app.add_option("--outfile", o.build.film.filename,
                   "image to write (.exr, .png, .pfm); overrides the scene's film filename")
        ->group(image);
    app.add_option("--aov", o.build.film.aovs,
                   fmt::format("channels of what the camera sees, added to the picture of any film: {}, with commas "
                               "between them; their names are those that denoisers read",
                               fmt::join(AovNames(), ", ")))
        ->delimiter(',')
        ->allow_extra_args(false)
        ->check(CLI::IsMember(AovNames()))
        ->type_name("NAME,...")
        ->group(image);
    app.add_flag("--write-partial-images", o.writePartialImages, "write the image after every wave of samples")
        ->group(image);
    app.add_option("--mse-reference-image", o.build.mseReferenceImage, "compare with this image after every wave")
        ->group(image);
    app.add_option("--mse-reference-out", o.build.mseReferenceOut, "file for the \"spp, mse\" lines of that comparison")
        ->group(image);

    const char *viewers = "Watching";
    app.add_option(
           "--display-server", o.displayServer,
           "HOST:PORT of a viewer that speaks tev's protocol (tev listens at localhost:14158): shows the picture "
           "as it grows")
        ->group(viewers);
    CLI::Option *serveOption = app.add_flag("--serve", port,
                                            "page for a browser on this machine: the picture as it grows, its error so "
                                            "far, time left; --serve PORT or --serve=PORT, 0: any free port")
                                   ->group(viewers);

    const char *effort = "Effort";
    CLI::Option *sppOption = app.add_option("--spp", spp, "samples per pixel; overrides the scene's sampler")
                                 ->check(PositiveNumber)
                                 ->group(effort);
    app.add_option("--time", o.timeBudget,
                   "render for this many seconds, preprocessing included, whatever --spp says; a short measurement "
                   "estimates the samples that this allows, and all is prepared as for that --spp")
        ->check(PositiveNumber)
        ->group(effort);
    CLI::Option *seedOption = app.add_option("--seed", seed, "seed of the pixel sampler (0)")->group(effort);
    app.add_option("--nthreads", o.threads, "threads (0: all cores)")->check(NonNegativeNumber)->group(effort);
    app.add_option(
           "--memory-limit", memoryLimitMb,
           "megabytes of memory that may be used; a scene that needs more is refused before it is built, as far "
           "as that can be known, else ends with a message")
        ->check(PositiveNumber)
        ->group(effort);
    app.add_flag("--quick", o.build.quick,
                 "a quarter of the resolution, one sample per pixel unless --spp says otherwise")
        ->group(effort);

    const char *keeping = "Long renders and many machines";
    app.add_option("--checkpoint", o.checkpoint,
                   "file that keeps all of the render, for --resume and for imgtool merge: written every "
                   "--checkpoint-interval seconds, at the end and on Ctrl-C")
        ->group(keeping);
    app.add_option("--checkpoint-interval", o.checkpointInterval,
                   "seconds between checkpoints (60), at least as long as one sample of every pixel takes")
        ->check(PositiveNumber)
        ->group(keeping);
    app.add_flag("--resume", o.resume,
                 "go on from the --checkpoint file, if it exists, to the same picture bit by bit; with a larger --spp "
                 "or --time than before, to a better one")
        ->group(keeping);
    app.add_option("--samples", samples,
                   "FIRST:END: render only these samples of every pixel, from FIRST up to END - 1, into the "
                   "--checkpoint file, without a picture; imgtool merge makes the picture from all parts")
        ->group(keeping);
    app.add_option(
           "--save-lights", o.saveLights,
           "file for what the light sampler, and the guide of guided paths, have learned by the end of the render")
        ->group(keeping);
    app.add_option("--load-lights", o.loadLights,
                   "choose lights and guide paths by what another render saved, and learn nothing: for parts of one "
                   "picture, and frames of an animation whose lights stand still; as --save-lights, renders in world "
                   "coordinates")
        ->group(keeping);

    const char *lights = "Light selection";
    app.add_option("--lightsampler", o.build.lightSampler,
                   "method that chooses the light for a shadow ray, see below; overrides the scene")
        ->group(lights);
    app.add_flag("--mesh-lights", o.build.meshLights, "the same as +mesh: an emissive mesh is one light")
        ->group(lights);
    app.add_option("--shooting-sampler", o.build.shootingSampler,
                   "name[:key=value,...] of the light sampler that chooses where light paths begin (bdpt, mlt, "
                   "lightpath, sppm): power, uniform or seen; overrides the scene")
        ->group(lights);
    app.add_flag_callback(
           "--list-lightsamplers", [&o] { o.list = "lightsamplers"; }, "the same as --list lightsamplers")
        ->group(lights);

    const char *method = "Method";
    app.add_option("--integrator", o.build.integrator,
                   "use this integrator instead of the scene's (path, simplepath, ...)")
        ->group(method);
    app.add_flag("--guide", o.build.guide,
                 "integrators path, volpath: end paths by what earlier samples found (\"guide.*\" parameters)")
        ->group(method);
    CLI::Option *depthOption =
        app.add_option("--maxdepth", maxDepth, "scattering events per path; 1: direct light only")
            ->check(NonNegativeNumber)
            ->group(method);
    app.add_flag("--disable-pixel-jitter", o.build.disablePixelJitter, "sample pixel centres only")->group(method);
    app.add_flag("--disable-wavelength-jitter", o.build.disableWavelengthJitter,
                 "the same wavelengths for every sample")
        ->group(method);
    app.add_flag("--disable-texture-filtering", o.build.disableTextureFiltering, "point-sample all textures")
        ->group(method);
    app.add_flag("--force-diffuse", o.build.forceDiffuse, "make every surface diffuse, with its own reflectance")
        ->group(method);
    app.add_option("--displacement-edge-scale", o.build.displacementEdgeScale,
                   "multiplies the \"edgelength\" of displaced meshes")
        ->check(PositiveNumber)
        ->group(method);
    app.add_option("--texture-cache-mb", o.build.textureCacheMb,
                   "memory for image textures; the rest is kept in a temporary folder (0: all in memory)")
        ->check(NonNegativeNumber)
        ->group(effort);
    app.add_flag("--ignore-media", o.build.ignoreMedia, "leave out media; the image is called ...-without-media")
        ->group(method);
    app.add_flag("--ignore-unsupported", o.build.ignoreUnsupported,
                 "leave out all that is not supported; the image is called ...-incomplete")
        ->group(method);
    app.add_option("--render-coord-sys", o.build.renderCoordSys, "camera, cameraworld (default) or world")
        ->check(CLI::IsMember({"camera", "cameraworld", "world"}))
        ->group(method);

    const char *messages = "Messages";
    app.add_option("--list", o.list,
                   "print what a scene can name, with all parameters, and stop: cameras, films, filters, samplers, "
                   "integrators, accelerators, shapes, materials, "
                   "floattextures, spectrumtextures, lights, arealights, media, lightsamplers; all; table")
        ->group(messages);
    app.add_flag("--quiet", o.quiet, "no progress and no warnings; errors only")->group(messages);
    CLI::Option *statsOption = app.add_flag("--stats", o.stats,
                                            "print statistics to standard output after rendering; --stats=json: as a "
                                            "JSON object, for scripts")
                                   ->group(messages);

    std::vector<std::string> arguments = CanonicalFlags(app, argc, argv);
    try {
        CheckFlags(app, arguments, StockFlags());
        std::reverse(arguments.begin(), arguments.end());  // CLI11 takes them from the back
        app.parse(arguments);
        if (o.build.mseReferenceImage.empty() != o.build.mseReferenceOut.empty())
            throw CLI::ValidationError("--mse-reference-image and --mse-reference-out go together");
        if (!samples.empty()) o.samples = ParseSamples(samples);
        CheckKeeping(o);
        CheckViewers(o);
        if (*serveOption) o.servePort = ParsePort(port);
        if (*statsOption) o.stats = ParseStats(o.stats);
    } catch (const CLI::CallForHelp &) {
        std::cout << app.help();
        result.done = true;
        return result;
    } catch (const CLI::CallForVersion &) {
        std::cout << VersionText() << "\n";
        result.done = true;
        return result;
    } catch (const CLI::ParseError &e) {
        std::cerr << "Error: " << e.what() << "\nRun with --help for all options.\n";
        result.done = true;
        result.status = 1;
        return result;
    }
    o.memoryLimit = 1e6 * memoryLimitMb;
    // A part makes no picture.
    o.build.checksOutput = !o.samples;
    if (*sppOption) o.build.samplesPerPixel = spp;
    if (*seedOption) o.build.seed = seed;
    if (*depthOption) o.build.maxDepth = maxDepth;
    if (!crop.empty()) o.build.film.cropWindow = Bounds2{{crop[0], crop[2]}, {crop[1], crop[3]}};
    if (!bounds.empty()) o.build.film.pixelBounds = Bounds2i{{bounds[0], bounds[2]}, {bounds[1], bounds[3]}};
    if (!pixel.empty()) o.build.film.pixelBounds = Bounds2i{{pixel[0], pixel[1]}, {pixel[0] + 1, pixel[1] + 1}};
    return result;
}

}  // namespace pbrt
