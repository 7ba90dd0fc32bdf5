#include "fuzz/corpus.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <stdexcept>

#include "fuzz/assets.h"

namespace pbrt::fuzz {

namespace {

namespace fs = std::filesystem;

constexpr size_t kMaxAssetBytes = 20000;

std::string ReadFile(const fs::path &path) {
    std::ostringstream bytes;
    bytes << std::ifstream(path, std::ios::binary).rdbuf();
    return bytes.str();
}

std::vector<fs::path> FilesBelow(const fs::path &folder) {
    std::vector<fs::path> files;
    for (const auto &entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file()) files.push_back(entry.path());
    std::sort(files.begin(), files.end());  // the order of a folder differs from machine to machine
    return files;
}

std::vector<std::string> AssetsNamedIn(const std::string &text) {
    static const std::regex kAsset(R"re("\.\./assets/([^"]+)")re");
    std::set<std::string> names;
    for (std::sregex_iterator i(text.begin(), text.end(), kAsset), end; i != end; ++i) names.insert((*i)[1]);
    return {names.begin(), names.end()};
}

}  // namespace

Corpus Corpus::Load(const std::string &assetFolder) {
    Corpus corpus;
    const fs::path suite = PBRT_SOURCE_DIR "/tests/conformance/suite/scenes";
    corpus.assets = MakeAssets(assetFolder);
    for (const fs::path &path : FilesBelow(suite / "assets"))
        if (fs::file_size(path) < kMaxAssetBytes)
            corpus.assets.push_back({path.lexically_relative(suite / "assets").string(), ReadFile(path)});
    for (const CaseFile &asset : corpus.assets) {
        const fs::path path = fs::path(assetFolder) / asset.name;
        fs::create_directories(path.parent_path());
        std::ofstream(path, std::ios::binary) << asset.bytes;
    }

    corpus.states = MakeStateSeeds(fs::path(assetFolder).parent_path().string());

    std::set<std::string> notSupported;
    std::ifstream list(PBRT_SOURCE_DIR "/tests/conformance/not_supported.txt");
    for (std::string name; list >> name;) notSupported.insert(name);

    auto add = [&](const fs::path &path, const std::string &name) {
        static const std::regex kResolution(R"re("integer ([xy])resolution" \[ \d+ \])re");
        SeedScene scene{name, ReadFile(path), {}, !name.starts_with("errors/") && !notSupported.contains(name)};
        if (scene.text.find("pixelbounds") == std::string::npos)
            scene.text = std::regex_replace(scene.text, kResolution, "\"integer $1resolution\" [ 12 ]");
        scene.assets = AssetsNamedIn(scene.text);
        // Assets too big for many runs are left out, and with them their scenes.
        for (const std::string &asset : scene.assets)
            if (!corpus.Asset(asset)) return;
        corpus.scenes.push_back(std::move(scene));
    };
    for (const fs::path &path : FilesBelow(PBRT_SOURCE_DIR "/tests/fuzz/seeds")) add(path, path.stem().string());
    for (const fs::path &path : FilesBelow(suite))
        if (path.extension() == ".pbrt" && path.parent_path().parent_path() == suite &&
            path.parent_path().filename() != "assets" && fs::file_size(path) < kMaxAssetBytes)
            add(path, path.lexically_relative(suite).replace_extension().string());
    if (corpus.scenes.size() < 20) throw std::runtime_error("the seed scenes are missing");
    return corpus;
}

const CaseFile *Corpus::Asset(const std::string &name) const {
    for (const CaseFile &asset : assets)
        if (asset.name == name) return &asset;
    return nullptr;
}

}  // namespace pbrt::fuzz
