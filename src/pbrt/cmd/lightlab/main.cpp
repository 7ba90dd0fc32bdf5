#include <unistd.h>

#include <cstdio>
#include <exception>
#include <new>
#include <stdexcept>

#include "pbrt/cmd/lightlab/command_line.h"
#include "pbrt/cmd/lightlab/report_scripts.h"
#include "pbrt/core/log.h"
#include "pbrt/core/memory.h"
#include "pbrt/core/parallel.h"
#include "pbrt/core/ranks.h"
#include "pbrt/core/signal_watch.h"
#include "pbrt/lab/campaign.h"
#include "plugins.h"

namespace {

/// Seconds from a signal to the end of the process. Records and pictures on disk are complete at any time, so nothing
/// needs to be waited for; but most work ends within this time and then leaves no unfinished files.
constexpr double kGraceSeconds = 0.4;

int Compare(const pbrt::LightlabOptions &options, const pbrt::LightSamplerRegistry &registry) {
    using namespace pbrt;
    lab::CampaignSettings settings = options.campaign;
    settings.samplers = lab::ParseSamplerChoices(options.samplers, registry);
    std::unique_ptr<ProgressSink> display = MakeTerminalProgress(options.quiet);
    const std::string goesOn =
        fmt::format("\nInterrupted. The same command goes on from what {} holds.", settings.outFolder);
    Progress cancel;
    SignalWatch signals(cancel, goesOn);
    signals.Cancel("", goesOn, kGraceSeconds);
    const std::optional<lab::CampaignOutcome> outcome = lab::RunCampaign(settings, registry, cancel, display.get());
    if (!outcome) {
        LogInfo(goesOn);
        return signals.Status();
    }
    std::printf("%s\n", outcome->text.c_str());
    std::fflush(stdout);
    signals.EndAtOnce(fmt::format("Interrupted: {} has no report yet. The same command makes it.", settings.outFolder));
    if (options.report)
        if (std::string problem = RunReportScripts(settings.outFolder, options.quiet); !problem.empty())
            LogWarning(problem);
    LogInfo(fmt::format("Wrote {}.", settings.outFolder));
    return signals.Status();
}

int Inspect(const pbrt::LightlabOptions &options, const pbrt::LightSamplerRegistry &registry) {
    using namespace pbrt;
    std::unique_ptr<ProgressSink> display = MakeTerminalProgress(options.quiet);
    Progress progress(display.get());
    SignalWatch signals(progress, "");
    signals.Cancel("", "Interrupted.", kGraceSeconds);
    const int status = lab::RunInspect(*options.inspect, registry, progress);
    if (signals.Status() == 0) return status;
    LogInfo("Interrupted.");
    return signals.Status();
}

}  // namespace

int main(int argc, char **argv) {
    using namespace pbrt;
    if (const RanksAnnounced announced = AnnouncedRanks(); announced.size > 1) {
        if (announced.rank == 0)
            std::fputs(
                "Error: lightlab measures seconds, which processes beside it would change; start it without mpirun.\n",
                stderr);
        return 1;
    }
    try {
        LightSamplerRegistry registry;
        RegisterPlugins(registry);
        const LightlabCommandLine parsed = ParseLightlabCommandLine(argc, argv, registry.samplers.Names());
        if (parsed.done) return parsed.status;
        if (parsed.options.quiet) SetLogLevel(LogLevel::Error);
        ThreadLimit threads(parsed.options.threads);
        return parsed.options.inspect ? Inspect(parsed.options, registry) : Compare(parsed.options, registry);
    } catch (const UserError &e) {
        std::fputs(FormatAll(e, isatty(STDERR_FILENO) != 0).c_str(), stderr);
        if (e.Count() > 1) std::fprintf(stderr, "%zu errors; nothing was rendered.\n", e.Count());
        return 1;
    } catch (const std::bad_alloc &) {
        std::fprintf(stderr, "Error: %s\n", OutOfMemoryText("").c_str());
        return 1;
    } catch (const std::length_error &) {
        std::fprintf(stderr, "Error: %s\n", OutOfMemoryText("").c_str());
        return 1;
    } catch (const std::exception &e) {
        std::fprintf(stderr, "Error: %s\n", e.what());
        return 1;
    }
}
