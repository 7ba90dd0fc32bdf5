#pragma once
#include <string>
#include <vector>

#include "fuzz/fuzz_case.h"

namespace pbrt::fuzz {

/// Splits at blanks.
std::vector<std::string> WordsOf(const std::string &text);

/// A number as text that is hard to parse, to store or to calculate with.
std::string ExtremeNumber(Dice &dice);

/// Flips, inserts, deletes, overwrites, cuts off, repeats. Changes within the first `head` bytes are as likely as in
/// the rest. Empty bytes change only if something is inserted.
void MutateBytes(std::string &bytes, size_t head, Dice &dice);

/// Replaces a number in a text by an extreme one, or changes it a little. False if there is none.
bool MutateNumberInText(std::string &text, size_t begin, size_t end, Dice &dice);

/// The kind of mutation an asset falls under, after its format: "ply-ascii", "ply-binary", "ply-gz", "exr", ...
std::string AssetKind(const CaseFile &asset);

/// Changes the file once, in most cases where its format stores counts, sizes and types.
void MutateAsset(CaseFile &asset, Dice &dice);

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

}  // namespace pbrt::fuzz
