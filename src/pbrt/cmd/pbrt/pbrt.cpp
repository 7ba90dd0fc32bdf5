#include <algorithm>
#include <cstdio>
#include <exception>
#include <iostream>
#include <new>
#include <stdexcept>
#include <system_error>
#include <thread>

#include <unistd.h>

#include "pbrt/build/built_scene.h"
#include "pbrt/cmd/pbrt/command_line.h"
#include "pbrt/cmd/pbrt/live_view.h"
#include "pbrt/cmd/pbrt/render_job.h"
#include "pbrt/core/log.h"
#include "pbrt/core/memory.h"
#include "pbrt/core/parallel.h"
#include "pbrt/core/team.h"
#include "plugins.h"

namespace pbrt {
namespace {

/// Threads of this process; 0: all cores. Processes on one machine share its cores.
int ThreadsOf(const CommandLine &options, const AnnouncedTeam &announced) {
    if (options.threads > 0 || announced.onThisMachine <= 1) return options.threads;
    const auto share = int(sysconf(_SC_NPROCESSORS_ONLN)) / announced.onThisMachine;
    // mpirun may have bound this process to fewer.
    return std::clamp(share, 1, std::max(1, int(std::thread::hardware_concurrency())));
}

}  // namespace

int RunPbrt(int argc, char **argv) {
    const AnnouncedTeam announced = ReadAnnouncedTeam();
    const bool isSilent = announced.rank > 0;
    if (isSilent) {
        std::cout.setstate(std::ios::failbit);
        std::cerr.setstate(std::ios::failbit);
        SetLogLevel(LogLevel::Quiet);
    }
    CommandLine options;
    PluginRegistry registry;
    RegisterPlugins(registry);
    const std::optional<int> status = ParseCommandLine(argc, argv, registry, &options);
    // All processes have the same command line. An error of another could make mpirun kill rank 0 before its report.
    if (status) return isSilent ? 0 : *status;
    if (options.quiet && !isSilent) SetLogLevel(LogLevel::Error);
    std::unique_ptr<ProgressSink> sink = MakeTerminalProgress(options.quiet || isSilent);
    LiveView live(sink.get());
    const bool isWatched = !isSilent && (options.servePort || !options.displayServer.empty());
    Progress progress(isWatched ? live.Sink() : sink.get());
    auto team = std::make_unique<Team>();
    // Other ranks cannot continue without this one.
    const auto fail = [&](const std::string &what) {
        std::fprintf(stderr, "Error: %s%s\n", team->Size() > 1 ? fmt::format("process {}: ", team->Rank()).c_str() : "",
                     what.c_str());
        team->Abort(1);
        return 1;
    };
    try {
        if (!options.list.empty()) {
            if (isSilent) return 0;
            std::fputs(
                (options.list == "lightsamplers" ? registry.Listing() : ListWhat(options.list, registry)).c_str(),
                stdout);
            return 0;
        }
        ThreadLimit threads(ThreadsOf(options, announced));
        SignalWatch signals(progress, isSilent ? "" : "Interrupted: no image was written.");
        team = ConnectTeam(ThreadCount());
        if (isWatched && !options.displayServer.empty()) live.SendTo(options.displayServer);
        if (isWatched && options.servePort) live.Serve(*options.servePort);
        return RunRenderJob(options, registry, *team, progress, signals, live);
    } catch (const AnotherRankFailed &) {
        return 1;
    } catch (const UserError &e) {
        team->Fail(e);
        if (isSilent) return 1;
        std::fputs(FormatAll(e, isatty(STDERR_FILENO) != 0).c_str(), stderr);
        if (e.Count() > 1 && progress.PhaseName() != "writing")
            std::fprintf(stderr, "%zu errors; nothing was rendered.\n", e.Count());
        return 1;
    } catch (const std::bad_alloc &) {
        return fail(OutOfMemoryText(progress.PhaseName()));
    } catch (const std::length_error &) {  // container beyond any memory
        return fail(OutOfMemoryText(progress.PhaseName()));
    } catch (const std::system_error &e) {  // most likely no memory for a thread's stack
        return fail(fmt::format("{}; most likely {}", e.what(), OutOfMemoryText(progress.PhaseName())));
    } catch (const std::exception &e) {
        return fail(e.what());
    }
}

}  // namespace pbrt
