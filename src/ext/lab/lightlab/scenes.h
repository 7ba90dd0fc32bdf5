#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace pbrt {

/// One scene of a comparison over several.
struct SceneOutcome {
    std::string scene;               ///< as on the command line
    std::string folder;              ///< of its campaign, relative to the common folder
    nlohmann::ordered_json results;  ///< its results.json; null if it failed
    std::string failure;             ///< why
};

/// Folders for campaigns on these scenes: the names of the files without ending; of equal ones the second gets "-2".
std::vector<std::string> SceneFolders(const std::vector<std::string> &scenes);

/// A row for every scene: the error of every sampler, with a star at the winner; the last row compares each with the
/// first.
std::string ScenesText(const std::vector<SceneOutcome> &outcomes);
/// scenes.csv, scenes.json and index.html in the common folder. Throws UserError.
void WriteScenes(const std::string &folder, const std::vector<SceneOutcome> &outcomes);

}  // namespace pbrt
