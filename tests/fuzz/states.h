#pragma once
#include <map>
#include <string>
#include <vector>

#include "fuzz/fuzz_case.h"
#include "pbrt/images/image.h"

namespace pbrt::fuzz {

/// A vector that StateWriter::Structure wrote into a section: its number of elements, they, their hash.
struct Structure {
    size_t at = 0, count = 0, size = 0;
    size_t First() const { return at + sizeof(uint64_t); }
    size_t HashAt() const { return First() + count * size; }
    size_t End() const { return HashAt() + sizeof(uint64_t); }
};

/// A file in which pbrt saved what a render had learned and summed up, or lightlab a reference, and the run that reads
/// it.
struct StateSeed {
    std::string name;
    std::string scene;  ///< text
    CaseFile file;
    std::vector<std::string> arguments;
    std::map<std::string, std::vector<Structure>> structures{};  ///< of the file, by section
    bool isLightlab = false;
    ImageFile picture{};  ///< the file of lightlab, read
};

/// Renders small scenes in child processes whose working folder is `folder`/states: checkpoints of renders that go on
/// learning, files of learned lights, and a reference of lightlab.
std::vector<StateSeed> MakeStateSeeds(const std::string &folder);

/// The run that reads the file as it is.
FuzzCase UnchangedCase(const StateSeed &seed);

/// A case of this seed, with a file that is changed and has a checksum that fits.
FuzzCase MakeStateCase(const StateSeed &seed, Dice &dice);

}  // namespace pbrt::fuzz
