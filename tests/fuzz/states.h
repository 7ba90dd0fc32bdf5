#pragma once
#include <string>
#include <vector>

#include "fuzz/fuzz_case.h"

namespace pbrt::fuzz {

/// A file in which pbrt saved what a render had learned and summed up, and the run that reads it.
struct StateSeed {
    std::string name;
    std::string scene;  ///< text
    CaseFile file;
    std::vector<std::string> arguments;
};

/// Renders small scenes in child processes whose working folder is `folder`/states: checkpoints of renders that go on
/// learning, and files of learned lights.
std::vector<StateSeed> MakeStateSeeds(const std::string &folder);

/// A case of this seed, with a file that is changed and has a checksum that fits.
FuzzCase MakeStateCase(const StateSeed &seed, Dice &dice);

}  // namespace pbrt::fuzz
