#include <unistd.h>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <new>
#include <stdexcept>

#include "ext/lab/experiment.h"
#include "ext/lab/lightlab/lightlab.h"
#include "ext/lab/noise_by_depth.h"
#include "pbrt/core/log.h"
#include "pbrt/core/parallel.h"
#include "pbrt/core/signal_watch.h"
#include "plugins.h"

namespace ext::lab {
namespace {

/// Seconds from a signal to process exit. Records and images on disk are always complete, so waiting is optional; but
/// most work ends within this time and then leaves no unfinished files.
constexpr double kGraceSeconds = 0.4;

std::string ResumeHint(const LightlabOptions &options) {
    return fmt::format("\nInterrupted: rerun the command to resume from the records in {}.",
                       options.experiment.outFolder);
}

/// All errors, one a line, without the quoted text.
std::string Headings(const UserError &e) {
    std::string all;
    for (const Diagnostic &d : e.Diagnostics()) {
        const std::string text = Format(d);
        all += (all.empty() ? "" : "\n") + text.substr(0, text.find('\n'));
    }
    return all;
}

/// Compares samplers on one scene. Empty if a signal ended it; `signals` then has the status.
std::optional<ExperimentOutcome> CompareOn(const ExperimentSettings &settings, const LightlabOptions &options,
                                           const PluginRegistry &registry, SignalWatch &signals, Progress &cancel) {
    std::unique_ptr<ProgressSink> display = MakeTerminalProgress(options.quiet);
    signals.Cancel("", ResumeHint(options), kGraceSeconds);
    std::optional<ExperimentOutcome> outcome = RunExperiment(settings, registry, cancel, display.get());
    if (!outcome) {
        LogInfo(ResumeHint(options));
        return {};
    }
    // A report of earlier results must not pass for one of these.
    for (const auto &entry : std::filesystem::directory_iterator(settings.outFolder))
        if (const std::string name = entry.path().filename();
            name == "report.html" || name == "table.md" || name.starts_with("chart-"))
            std::filesystem::remove(entry);
    std::printf("%s\n", outcome->text.c_str());
    std::fflush(stdout);
    signals.EndAtOnce(
        fmt::format("Interrupted: {} has no report yet; rerun the command to write it.", settings.outFolder));
    if (options.report)
        if (std::string problem = RunReportScripts(settings.outFolder, options.quiet); !problem.empty())
            LogWarning(problem);
    LogInfo("Wrote {}.", settings.outFolder);
    return outcome;
}

int Compare(const LightlabOptions &options, const PluginRegistry &registry) {
    ExperimentSettings settings = options.experiment;
    settings.samplers = ParseSamplerChoices(options.samplers, registry);
    Progress cancel;
    SignalWatch signals(cancel, ResumeHint(options));
    if (options.scenes.size() == 1) {
        CompareOn(settings, options, registry, signals, cancel);
        return signals.Status();
    }
    DiagnosticSink missing;
    for (const std::string &scene : options.scenes)
        if (!FileExists(scene)) missing.Error({}, "{}: No such file or directory.", scene);
    missing.ThrowIfErrors();
    const std::vector<std::string> folders = SceneFolders(options.scenes);
    std::vector<SceneOutcome> outcomes;
    bool hasFailed = false;
    for (size_t i = 0; i < folders.size(); ++i) {
        settings.scene = options.scenes[i];
        settings.outFolder = options.experiment.outFolder + "/" + folders[i];
        SceneOutcome &scene = outcomes.emplace_back(SceneOutcome{settings.scene, folders[i], {}, {}});
        std::printf("%s%s\n\n", i ? "\n" : "", settings.scene.c_str());
        try {
            std::optional<ExperimentOutcome> outcome = CompareOn(settings, options, registry, signals, cancel);
            if (!outcome) return signals.Status();
            scene.results = std::move(outcome->results);
        } catch (const UserError &e) {
            std::fputs(FormatAll(e, isatty(STDERR_FILENO) != 0).c_str(), stderr);
            scene.failure = Headings(e);
            hasFailed = true;
        }
    }
    WriteScenes(options.experiment.outFolder, outcomes);
    std::printf("\nAll scenes\n\n%s", ScenesText(outcomes).c_str());
    LogInfo("Wrote {}/index.html.", options.experiment.outFolder);
    return hasFailed ? 1 : signals.Status();
}

int RunSubcommand(const LightlabOptions &options, const PluginRegistry &registry) {
    std::unique_ptr<ProgressSink> display = MakeTerminalProgress(options.quiet);
    Progress progress(display.get());
    SignalWatch signals(progress, "Interrupted.");
    signals.Cancel("", "Interrupted.", kGraceSeconds);
    ExperimentSettings settings = options.experiment;
    if (options.noise) settings.samplers = ParseSamplerChoices(options.samplers, registry);
    const int status =
        options.inspect ? RunInspect(*options.inspect, registry, progress) : RunNoise(settings, registry, progress);
    if (signals.Status() == 0) return status;
    LogInfo("Interrupted.");
    return signals.Status();
}

}  // namespace

int RunLightlab(int argc, char **argv) {
    if (const AnnouncedTeam announced = ReadAnnouncedTeam(); announced.size > 1) {
        if (announced.rank == 0)
            std::fputs(
                "Error: lightlab measures seconds, which processes beside it would change; start it without mpirun.\n",
                stderr);
        return 1;
    }
    try {
        PluginRegistry registry;
        RegisterPlugins(registry);
        LightlabOptions options;
        if (auto status = ParseLightlabCommandLine(argc, argv, registry.samplers.Names(), options)) return *status;
        if (options.quiet) SetLogLevel(LogLevel::Error);
        ThreadLimit threads(options.threads);
        return options.inspect || options.noise ? RunSubcommand(options, registry) : Compare(options, registry);
    } catch (const UserError &e) {
        std::fputs(FormatAll(e, isatty(STDERR_FILENO) != 0).c_str(), stderr);
        if (e.Count() > 1) std::fprintf(stderr, "%zu errors; nothing was rendered.\n", e.Count());
        return 1;
    } catch (const std::exception &e) {
        const bool isMemory = dynamic_cast<const std::bad_alloc *>(&e) || dynamic_cast<const std::length_error *>(&e);
        std::fprintf(stderr, "Error: %s\n", isMemory ? OutOfMemoryText("").c_str() : e.what());
        return 1;
    }
}

}  // namespace ext::lab
