#pragma once
#include <string>
#include <vector>

#include "fuzz/fuzz_case.h"
#include "fuzz/states.h"

namespace pbrt::fuzz {

struct SeedScene {
    std::string name, text;
    std::vector<std::string> assets;  ///< names of the files in ../assets that it names
    bool isRendered = true;  ///< false: pbrt refuses the scene as it is, so that only its text serves for mutations
};

/// The input of the mutations: the scenes of tests/fuzz/seeds and of the conformance suite, the latter with films of 12
/// x 8 pixels, and the assets they name. All assets are also written to `assetFolder`.
struct Corpus {
    std::vector<SeedScene> scenes;
    std::vector<CaseFile> assets;
    std::vector<StateSeed> states;

    static Corpus Load(const std::string &assetFolder);
    const CaseFile *Asset(const std::string &name) const;
};

}  // namespace pbrt::fuzz
