#include <cstdio>
#include <exception>
#include <new>
#include <stdexcept>
#include <system_error>

#include <unistd.h>

#include "pbrt/build/catalogue.h"
#include "pbrt/cmd/pbrt/command_line.h"
#include "pbrt/cmd/pbrt/live_view.h"
#include "pbrt/cmd/pbrt/render_job.h"
#include "pbrt/core/log.h"
#include "pbrt/core/memory.h"
#include "pbrt/core/parallel.h"
#include "plugins.h"

int main(int argc, char **argv) {
    using namespace pbrt;
    CommandLineResult parsed = ParseCommandLine(argc, argv);
    if (parsed.done) return parsed.status;
    const CommandLine &options = parsed.options;
    if (options.quiet) SetLogLevel(LogLevel::Error);
    std::unique_ptr<ProgressSink> sink = MakeTerminalProgress(options.quiet);
    LiveView live(sink.get());
    const bool isWatched = options.servePort || !options.displayServer.empty();
    Progress progress(isWatched ? live.Sink() : sink.get());
    try {
        LightSamplerRegistry registry;
        RegisterPlugins(registry);
        if (!options.list.empty()) {
            std::fputs((options.list == "lightsamplers" ? registry.Listing() : ListWhat(options.list)).c_str(), stdout);
            return 0;
        }
        ThreadLimit threads(options.threads);
        SignalWatch signals(progress, "Interrupted: no image was written.");
        if (!options.displayServer.empty()) live.SendTo(options.displayServer);
        if (options.servePort) live.Serve(*options.servePort);
        return RunRenderJob(options, registry, progress, signals, live);
    } catch (const UserError &e) {
        std::fputs(FormatAll(e, isatty(STDERR_FILENO) != 0).c_str(), stderr);
        if (e.Count() > 1) std::fprintf(stderr, "%zu errors; nothing was rendered.\n", e.Count());
        return 1;
    } catch (const std::bad_alloc &) {
        std::fprintf(stderr, "Error: %s\n", OutOfMemoryText(progress.PhaseName()).c_str());
        return 1;
    } catch (const std::length_error &) {  // a container that would be larger than any memory
        std::fprintf(stderr, "Error: %s\n", OutOfMemoryText(progress.PhaseName()).c_str());
        return 1;
    } catch (const std::system_error &e) {  // most likely a thread that got no memory for its stack
        std::fprintf(stderr, "Error: %s; most likely %s\n", e.what(), OutOfMemoryText(progress.PhaseName()).c_str());
        return 1;
    } catch (const std::exception &e) {
        std::fprintf(stderr, "Error: %s\n", e.what());
        return 1;
    }
}
