#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pbrt/build/build_options.h"

namespace pbrt {

/// The options of the pbrt command line.
struct CommandLine {
    BuildOptions build;
    std::vector<std::string> sceneFiles;
    int threads = 0;
    bool quiet = false, writePartialImages = false;
    std::string stats;  ///< "text" or "json": statistics to standard output; empty: none
    std::string list;   ///< what to list instead of rendering
    double timeBudget = 0;
    std::string checkpoint;  ///< file for checkpoints; empty: none
    double checkpointInterval = 60;
    bool resume = false;
    std::optional<std::pair<int, int>> samples;  ///< only the samples [first, second) of every pixel
    std::string saveLights, loadLights;          ///< files of what the light sampler learned
    double memoryLimit = 0;                      ///< bytes; 0: what the machine has
    std::string displayServer;                   ///< host:port of a viewer; empty: none
    std::optional<int> servePort;                ///< of the live page; -1: a usual one
    std::string text;                            ///< as typed, for image metadata
};

/// Returns the scene files named on the command line, or standard input.
inline std::vector<std::string> SceneFilesOf(const CommandLine &options) {
    return options.sceneFiles.empty() ? std::vector<std::string>{"-"} : options.sceneFiles;
}

/// What to do after parsing the arguments.
struct CommandLineResult {
    CommandLine options;
    bool done = false;  ///< help or error was printed: exit with `status`
    int status = 0;
};

/// Parses flags as stock pbrt-v4 does: one or two dashes, `-`, `_` and case inside names ignored, `--name value` or
/// `--name=value` (pbrt-v4-format §13), plus our own.
CommandLineResult ParseCommandLine(int argc, const char *const *argv);

}  // namespace pbrt
