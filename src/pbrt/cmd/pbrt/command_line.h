#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pbrt/build/built_scene.h"

namespace pbrt {

struct CommandLine {
    BuildOptions build;
    std::vector<std::string> sceneFiles;  ///< "-": standard input
    int threads = 0;
    bool quiet = false, writePartialImages = false;
    std::string stats;                 ///< "text" or "json": statistics to standard output; empty: none
    std::string list;                  ///< topic to list instead of rendering
    double timeBudget = 0, noise = 0;  ///< --time in seconds, --noise; 0: none
    std::string checkpoint;            ///< file for checkpoints; empty: none
    double checkpointInterval = 60;
    bool resume = false;
    std::optional<std::pair<int, int>> samples;  ///< sample range [first, second) of every pixel
    std::string saveLights, loadLights;          ///< learned lights
    double memoryLimit = 0;                      ///< bytes; 0: the machine's memory
    std::string displayServer;                   ///< host:port of a viewer; empty: none
    std::optional<int> servePort;                ///< of the live page; -1: the default
    std::string text;                            ///< as typed, for image metadata
};

/// Parses flags as stock pbrt-v4: one or two dashes; `-`, `_` and case in names ignored; `--name value` or
/// `--name=value` (pbrt-v4-format §13). Adds our own. The help text names samplers of the registry only. After printing
/// help, version or an error, returns the exit status.
std::optional<int> ParseCommandLine(int argc, const char *const *argv, const PluginRegistry &registry,
                                    CommandLine *options);

}  // namespace pbrt
