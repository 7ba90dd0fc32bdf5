#pragma once
#include <string>
#include <vector>

#include "fuzz/fuzz_case.h"

namespace pbrt::fuzz {

/// Kinds of mutations of scene texts: "scene-numbers", "scene-names", ...
const std::vector<std::string> &SceneKinds();

/// The material of scene mutations: strings, parameters and statements of all seeds.
struct SceneWords {
    std::vector<std::string> strings;     ///< with quotes
    std::vector<std::string> parameters;  ///< `"type name" [ values ]`
    std::vector<std::string> statements;
    std::vector<std::string> texts;
    /// Collects the material from scenes.
    explicit SceneWords(const std::vector<std::string> &scenes);
};

/// Changes the text once, in the manner of `kind`.
void MutateScene(std::string &text, const std::string &kind, const SceneWords &words, Dice &dice);

/// Changes bytes, numbers or lines: for files that are included.
void MutateSceneText(std::string &text, Dice &dice);

}  // namespace pbrt::fuzz
