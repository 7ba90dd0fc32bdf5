#pragma once
#include <string>
#include <vector>

#include "ext/lab/experiment_settings.h"
#include "ext/lab/inspect.h"
#include "ext/lab/noise_by_depth.h"
#include "ext/lab/text_output.h"

namespace ext::lab {

/// The options of the lightlab command line.
struct LightlabOptions {
    ExperimentSettings experiment;    ///< without the samplers
    std::vector<std::string> scenes;  ///< more than one: an experiment on each, in folders of their own
    std::vector<std::string> samplers;
    std::optional<InspectOptions> inspect;  ///< set: `lightlab inspect`
    std::optional<NoiseOptions> noise;      ///< set: `lightlab noise`
    int threads = 0;
    bool quiet = false, report = true;
};

struct LightlabCommandLine {
    LightlabOptions options;
    bool done = false;  ///< help or an error was printed: exit with `status`
    int status = 0;
};

/// `registered`: light samplers of this build, for the default list.
LightlabCommandLine ParseLightlabCommandLine(int argc, const char *const *argv,
                                             const std::vector<std::string> &registered);

/// "x0,y0,x1,y1;..." in pixels of the picture, the second corner excluded. Throws UserError.
std::vector<Bounds2i> ParseCrops(const std::string &text);

/// Runs charts.py and report.py on a finished experiment. Returns an error message, empty on success. The results are
/// not changed.
std::string RunReportScripts(const std::string &outFolder, bool quiet);

/// One scene of a comparison over several.
struct SceneOutcome {
    std::string scene;    ///< as on the command line
    std::string folder;   ///< of its experiment, relative to the common folder
    Json results;         ///< its results.json; null if it failed
    std::string failure;  ///< why
};

/// Returns folders for experiments on these scenes: file names without ending, with "-2", ... for equal ones.
std::vector<std::string> SceneFolders(const std::vector<std::string> &scenes);

/// Returns a table with a row per scene: the error of every sampler, a star at the winner; last, ratios to the first
/// sampler.
std::string ScenesText(const std::vector<SceneOutcome> &outcomes);
/// Writes scenes.csv, scenes.json and index.html into the common folder. Throws UserError.
void WriteScenes(const std::string &folder, const std::vector<SceneOutcome> &outcomes);

}  // namespace ext::lab
