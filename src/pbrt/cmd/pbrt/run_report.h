#pragma once
#include <string>
#include <utility>
#include <vector>

#include "pbrt/build/built_scene.h"
#include "pbrt/cmd/pbrt/command_line.h"
#include "pbrt/integrators/render_loop.h"

namespace pbrt {

/// Seconds of the phases of a run, in order; shown by the progress lines, the last line and --stats.
struct Timings {
    double startUp = 0;  ///< from the start of the process to reading
    double read = 0, build = 0, prepare = 0, render = 0, write = 0;

    std::vector<std::pair<std::string, double>> Phases() const {
        return {{"start-up", startUp},         {"reading", read},     {"building", build},
                {"preparing lights", prepare}, {"rendering", render}, {"writing", write}};
    }
    double Total() const { return startUp + read + build + prepare + render + write; }
};

/// Returns the seconds since the process was started, in steps of the kernel's clock (10 ms).
double SecondsSinceProcessStart();

/// Returns what a picture depends on and its cost, for the file's header.
ImageMetadata DescribeImage(const CommandLine &options, const BuiltScene &built, const RenderResult &result,
                            const Timings &timings);

/// Prints the text of --stats to standard output.
void PrintStatistics(const BuiltScene &built, const RenderResult &result, const Timings &timings);
/// Prints the JSON object of --stats=json to standard output; docs/guide/scripting/stats.schema.json describes it.
/// `picture`: the file that was written, or empty.
void PrintStatisticsJson(const CommandLine &options, const BuiltScene &built, const RenderResult &result,
                         const Timings &timings, const std::string &picture);

}  // namespace pbrt
