#pragma once
#include <functional>

#include "fuzz/corpus.h"
#include "fuzz/mutators.h"

namespace pbrt::fuzz {

/// Makes cases. A case depends on (seed, number) and the corpus only.
class CaseMaker {
  public:
    explicit CaseMaker(Corpus corpus);

    /// All kinds of mutations, sorted.
    const std::vector<std::string> &Kinds() const { return kinds_; }
    /// A case of one of `kinds`.
    FuzzCase Make(uint64_t seed, uint64_t number, const std::vector<std::string> &kinds) const;
    /// A case with a scene of the corpus, not mutated.
    FuzzCase Unchanged(const SeedScene &scene) const;
    const Corpus &Seeds() const { return corpus_; }

  private:
    struct Use {
        const SeedScene *scene;
        const CaseFile *asset;
    };
    void AddArguments(FuzzCase &made, Dice &dice) const;
    Corpus corpus_;
    SceneWords words_;
    std::vector<const SeedScene *> rendered_;
    std::map<std::string, std::vector<Use>> uses_;  ///< of assets, by kind
    std::vector<std::string> kinds_;
};

/// Makes a failing case smaller as long as `stillFails` is true, for the same reason: leaves out arguments,
/// then lines, words and bytes of its files, many at once first. Calls `stillFails` at most `maxTries` times.
FuzzCase Shrink(FuzzCase failing, const std::function<bool(const FuzzCase &)> &stillFails, int maxTries);

}  // namespace pbrt::fuzz
