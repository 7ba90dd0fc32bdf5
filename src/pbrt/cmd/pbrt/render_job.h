#pragma once
#include "pbrt/cmd/pbrt/command_line.h"
#include "pbrt/cmd/pbrt/live_view.h"
#include "pbrt/core/signal_watch.h"
#include "pbrt/core/team.h"
#include "pbrt/integrators/registry.h"

namespace pbrt {

/// The program pbrt: parses the command line, renders, prints errors. Returns the exit status.
int RunPbrt(int argc, char **argv);

/// Reads, builds, renders and writes one image. Throws UserError. Returns the exit status: 0, or 128 plus the number of
/// a signal that ended the render early, after saving its samples. `team`: processes that render the image together,
/// all of which call this; rank 0 writes. `live` shows the progressive image.
int RunRenderJob(const CommandLine &options, const PluginRegistry &registry, Team &team, Progress &progress,
                 SignalWatch &signals, LiveView &live);

}  // namespace pbrt
