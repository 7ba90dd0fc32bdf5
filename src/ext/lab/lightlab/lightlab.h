#pragma once
#include <string>
#include <vector>

#include "ext/lab/experiment_settings.h"
#include "ext/lab/inspect.h"

namespace ext::lab {

/// The program lightlab: parses the command line, runs its experiments, prints errors. Returns the exit status.
int RunLightlab(int argc, char **argv);

struct LightlabOptions {
    ExperimentSettings experiment;    ///< excluding the samplers
    std::vector<std::string> scenes;  ///< several: one experiment each, in separate folders
    std::vector<std::string> samplers;
    std::optional<InspectOptions> inspect;  ///< set: `lightlab inspect`
    bool noise = false;                     ///< `lightlab noise`
    int threads = 0;
    bool quiet = false, report = true;
};

/// Sets `options`. Returns the exit status after printing help or an error. `registered`: light samplers of this build.
std::optional<int> ParseLightlabCommandLine(int argc, const char *const *argv,
                                            const std::vector<std::string> &registered, LightlabOptions &options);

/// Runs charts.py and report.py on a finished experiment. Returns an error message, empty on success.
std::string RunReportScripts(const std::string &outFolder, bool quiet);

struct SceneOutcome {
    std::string scene;    ///< as typed
    std::string folder;   ///< of its experiment, relative to the common folder
    Json results;         ///< null if it failed
    std::string failure;  ///< its errors, one a line
};

/// Folder names for experiments on these scenes: file stems, with "-2", ... for equal ones.
std::vector<std::string> SceneFolders(const std::vector<std::string> &scenes);

/// Table with a row per scene: errors of all samplers, a star at the winner; last row: ratios to the first sampler.
std::string ScenesText(const std::vector<SceneOutcome> &outcomes);
/// Writes scenes.csv, scenes.json and index.html into the common folder. Throws UserError.
void WriteScenes(const std::string &folder, const std::vector<SceneOutcome> &outcomes);

}  // namespace ext::lab
