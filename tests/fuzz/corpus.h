#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "fuzz/fuzz_case.h"
#include "pbrt/images/image.h"

namespace pbrt::fuzz {

/// The bytes of a file; empty if there is none.
std::string BytesOf(const std::filesystem::path &path);
/// The same; removes the file.
std::string TakeFile(const std::filesystem::path &path);

/// gzip of `bytes`, and back. Uncompress returns what could be uncompressed.
std::string Compress(const std::string &bytes);
std::string Uncompress(const std::string &bytes);

/// Small files of every format that scenes can name, made by code: images of 8 x 8 pixels, meshes of a dozen faces, a
/// measured BSDF, a lens, a spectrum. Always the same bytes. `folder` is for temporary files.
std::vector<CaseFile> MakeAssets(const std::string &folder);

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

/// Renders small scenes in child processes whose working folder is `folder`/states: checkpoints of renders that resume
/// learning, files of learned lights, and a reference of lightlab.
std::vector<StateSeed> MakeStateSeeds(const std::string &folder);

/// The run that reads the file as it is.
FuzzCase UnchangedCase(const StateSeed &seed);

/// A case of this seed, with a file that is changed and has a checksum that fits.
FuzzCase MakeStateCase(const StateSeed &seed, Dice &dice);

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
