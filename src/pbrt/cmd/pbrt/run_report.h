#pragma once
#include <string>
#include <vector>

#include "pbrt/build/built_scene.h"
#include "pbrt/cmd/pbrt/command_line.h"
#include "pbrt/integrators/render_loop.h"

namespace pbrt {

/// Seconds per phase of a run, in order; for progress lines, the last line and --stats.
struct Timings {
    double startUp = 0;  ///< from process start to reading
    double read = 0, build = 0, prepare = 0, render = 0, write = 0;

    struct Phase {
        const char *name, *key;  ///< for the user; for JSON
        double seconds;
    };
    std::vector<Phase> Phases() const {
        return {{"start-up", "startUp", startUp},   {"reading", "reading", read},
                {"building", "building", build},    {"preparing lights", "preparingLights", prepare},
                {"rendering", "rendering", render}, {"writing", "writing", write}};
    }
    double Total() const { return startUp + read + build + prepare + render + write; }
};

/// Seconds since process start, in steps of the kernel's clock (10 ms).
double SecondsSinceProcessStart();

/// Image header: settings that determine the image, and its cost.
ImageMetadata DescribeImage(const CommandLine &options, const BuiltScene &built, const RenderResult &result,
                            const Timings &timings);

void PrintStatistics(const BuiltScene &built, const RenderResult &result, const Timings &timings);
/// Prints the JSON of --stats=json to standard output; schema: docs/guide/scripting/stats.schema.json. `picture`: file
/// written, or empty.
void PrintStatisticsJson(const CommandLine &options, const BuiltScene &built, const RenderResult &result,
                         const Timings &timings, const std::string &picture);

}  // namespace pbrt
