#include "pbrt/cmd/pbrt/render_job.h"

#include <unistd.h>

#include <cstdio>

#include "pbrt/build/built_scene.h"
#include "pbrt/core/counters.h"
#include "pbrt/core/files.h"
#include "pbrt/core/log.h"
#include "pbrt/core/parallel.h"
#include "pbrt/integrators/render_loop.h"
#include "pbrt/scenefile/parser.h"
#include "version.h"

namespace pbrt {

namespace {

void PrintWarnings(const DiagnosticSink &sink, size_t *printed) {
    bool color = isatty(STDERR_FILENO) != 0;
    const std::vector<Diagnostic> &all = sink.All();
    for (; *printed < all.size(); ++*printed)
        if (all[*printed].severity == Severity::Warning) LogInfo(Format(all[*printed], color));
}

struct Timings {
    double read = 0, build = 0, prepare = 0;
};

/// Whatever a sampler or gate reports, as attributes.
template <class Reporter>
void AddReport(const Reporter &reporter, const std::string &prefix, ImageMetadata *m) {
    nlohmann::ordered_json report = nlohmann::ordered_json::object();
    reporter.Report(report);
    for (const auto &[key, value] : report.items()) {
        std::string name = prefix + key;
        if (value.is_number_integer()) m->attributes[name] = value.template get<int>();
        else if (value.is_number()) m->attributes[name] = value.template get<float>();
        else if (value.is_string()) m->attributes[name] = value.template get<std::string>();
        else m->attributes[name] = value.dump();
    }
}

ImageMetadata DescribeImage(const CommandLine &options, const BuiltScene &built, const RenderResult &result, const Timings &timings) {
    ImageMetadata m = built.film->Metadata();
    m.attributes["renderTimeSeconds"] = static_cast<float>(result.seconds);
    m.attributes["samplesPerPixel"] = result.samplesTaken;
    m.attributes["worldToCamera"] = built.cameraFromWorld.Matrix();
    if (std::optional<Transform> ndc = built.camera->NdcFromCamera())
        m.attributes["worldToNDC"] = (*ndc * built.cameraFromWorld).Matrix();
    if (result.mse) m.attributes["MSE"] = static_cast<float>(*result.mse);
    m.attributes["pbrt.commandLine"] = options.text;
    m.attributes["pbrt.version"] = std::string(PBRT_VERSION_TEXT);
    m.attributes["pbrt.seed"] = built.seed;
    m.attributes["pbrt.integrator"] = built.integratorName;
    m.attributes["pbrt.maxDepth"] = built.maxDepth;
    m.attributes["pbrt.readSeconds"] = static_cast<float>(timings.read);
    m.attributes["pbrt.buildSeconds"] = static_cast<float>(timings.build);
    m.attributes["pbrt.prepareSeconds"] = static_cast<float>(timings.prepare);
    if (result.cancelled) m.attributes["pbrt.interrupted"] = 1;
    if (const LightSampler *lights = built.integrator->Lights()) {
        m.attributes["lightSampler"] = built.lightSamplerName;
        AddReport(*lights, "lightSampler.", &m);
    }
    if (const ShadowRayGate *gate = built.integrator->Gate()) {
        m.attributes["shadowGate"] = built.shadowGateName;
        AddReport(*gate, "shadowGate.", &m);
    }
    return m;
}

void PrintStatistics(const BuiltScene &built, const RenderResult &result, const Timings &timings) {
    RenderCounters c = SumCounters();
    auto line = [](const char *what, const std::string &value) { std::printf("  %-34s %s\n", what, value.c_str()); };
    auto share = [](uint64_t part, uint64_t whole) { return whole ? 100.0 * static_cast<double>(part) / static_cast<double>(whole) : 0.0; };
    std::printf("Statistics\n");
    line("reading, building (s)", fmt::format("{:.3f}, {:.3f}", timings.read, timings.build));
    line("preparing lights (s)", fmt::format("{:.3f}", timings.prepare));
    line("rendering (s)", fmt::format("{:.3f}", result.seconds));
    line("samples per pixel", fmt::format("{}", result.samplesTaken));
    line("shapes, lights", fmt::format("{}, {}", built.scene->ShapeCount(), built.scene->Lights().Size()));
    line("acceleration structure (MB)", fmt::format("{:.1f}", static_cast<double>(built.scene->Acceleration().Bytes()) / 1e6));
    line("camera paths", fmt::format("{}", c.cameraPaths));
    line("path vertices", fmt::format("{} ({:.2f} a path)", c.pathVertices, c.cameraPaths ? static_cast<double>(c.pathVertices) / static_cast<double>(c.cameraPaths) : 0.0));
    line("closest-hit rays", fmt::format("{}", c.closestHitRays));
    line("shadow rays", fmt::format("{} ({:.1f} % blocked)", c.shadowRays, share(c.shadowRaysBlocked, c.shadowRays)));
    line("rays per second (million)", fmt::format("{:.2f}", static_cast<double>(c.closestHitRays + c.shadowRays) / std::max(1e-9, result.seconds) / 1e6));
    if (built.film->RejectedSamples()) line("samples dropped (not finite)", fmt::format("{}", built.film->RejectedSamples()));
    auto list = [&](const char *what, const std::string &name, const auto &reporter) {
        nlohmann::ordered_json report = nlohmann::ordered_json::object();
        reporter.Report(report);
        line(what, name);
        for (const auto &[key, value] : report.items()) line(("  " + key).c_str(), value.is_string() ? value.template get<std::string>() : value.dump());
    };
    if (const LightSampler *lights = built.integrator->Lights()) list("light sampler", built.lightSamplerName, *lights);
    if (const ShadowRayGate *gate = built.integrator->Gate()) list("shadow-ray gate", built.shadowGateName, *gate);
}

}  // namespace

int RunRenderJob(const CommandLine &options, const LightSamplerRegistry &registry, Progress &progress) {
    const auto start = std::chrono::steady_clock::now();
    Timings timings;
    DiagnosticSink sink;
    size_t printed = 0;

    progress.BeginPhase("reading", 0);
    std::vector<std::string> files = options.sceneFiles;
    if (files.empty()) files = {"-"};
    SceneDescription description = ParseSceneFiles(files, sink);
    PrintWarnings(sink, &printed);
    sink.ThrowIfErrors();
    timings.read = progress.EndPhase();

    const auto buildStart = std::chrono::steady_clock::now();
    BuiltScene built = [&] {
        try {
            return BuildScene(description, options.build, registry, sink, progress);
        } catch (...) {
            PrintWarnings(sink, &printed);
            throw;
        }
    }();
    description.shapes.clear();
    PrintWarnings(sink, &printed);
    timings.build = std::chrono::duration<double>(std::chrono::steady_clock::now() - buildStart).count();
    const std::string filename = built.film->Filename();
    CheckWritable(filename);
    if (!built.mseReferenceOut.empty()) CheckWritable(built.mseReferenceOut);

    RenderSettings settings;
    settings.samplesPerPixel = built.samplesPerPixel;
    settings.timeBudget = options.timeBudget;
    settings.start = start;
    settings.disablePixelJitter = built.disablePixelJitter;
    settings.disableWavelengthJitter = built.disableWavelengthJitter;
    settings.mseReferenceImage = built.mseReferenceImage;
    settings.mseReferenceOut = built.mseReferenceOut;

    PrepareContext prepare{*built.scene, *built.camera, *built.filter, built.film->PixelBounds(), built.seed,
                           built.samplesPerPixel, built.maxDepth, progress};
    const auto prepareStart = std::chrono::steady_clock::now();
    built.integrator->Prepare(prepare);
    timings.prepare = std::chrono::duration<double>(std::chrono::steady_clock::now() - prepareStart).count();
    ResetCounters();
    if (progress.Cancelled()) {
        LogInfo("Interrupted before rendering: no image was written.");
        return 130;
    }

    RenderResult result;
    auto write = [&] { WriteImage(filename, built.film->ToImage(), DescribeImage(options, built, result, timings)); };
    if (options.writePartialImages)
        settings.afterWave = [&](int samples) {
            result.samplesTaken = samples;
            write();
        };
    result = RenderWaves(*built.integrator, *built.camera, *built.filter, *built.film, built.makeSampler, settings, progress);
    write();
    if (result.cancelled) LogInfo("Interrupted: the image holds what was rendered.");
    LogInfo(fmt::format("Wrote {} ({} samples per pixel, {:.2f} s).", filename, result.samplesTaken, result.seconds));
    if (options.stats) PrintStatistics(built, result, timings);
    if (!result.mseFailure.empty()) throw UserError(result.mseFailure);
    return result.cancelled ? 130 : 0;
}

}  // namespace pbrt
