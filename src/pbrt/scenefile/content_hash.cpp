#include "pbrt/scenefile/content_hash.h"

#include <cstring>
#include <filesystem>
#include <functional>
#include <vector>

#include "pbrt/core/files.h"
#include "pbrt/math/rng.h"

namespace pbrt {
namespace {

std::vector<std::string> QuotedStrings(const std::string &text) {
    std::vector<std::string> strings;
    for (size_t i = 0; i < text.size(); ++i) {
        if (text[i] == '#') {
            i = std::min(text.find('\n', i), text.size());
        } else if (text[i] == '"') {
            size_t end = text.find('"', i + 1);
            if (end == std::string::npos) break;
            strings.push_back(text.substr(i + 1, end - i - 1));
            i = end;
        }
    }
    return strings;
}

using Visit = std::function<void(const std::string &path, const std::string &content)>;

/// Visits the scene file and all files it names except `names`.
void VisitFiles(const std::string &scenePath, const Visit &visit, std::set<std::string> names = {}) {
    const FileResolver files(std::filesystem::path(scenePath).parent_path());
    std::set<std::string> seen;
    const std::function<void(const std::string &, bool)> add = [&](const std::string &path, bool isScene) {
        if (!seen.insert(path).second) return;
        const std::string content = ReadFileContents(path);
        visit(path, content);
        if (!isScene) return;
        for (const std::string &name : QuotedStrings(content)) {
            // Most strings are recurring parameter names.
            if (name.empty() || !names.insert(name).second) continue;
            std::error_code none;
            std::string file = files.Resolve(name);
            if (std::filesystem::is_regular_file(file, none))
                add(file, file.ends_with(".pbrt") || file.ends_with(".pbrt.gz"));
        }
    };
    add(scenePath, true);
}

}  // namespace

void ContentHash::Add(const std::string &bytes) {
    hash_ = MixBits(hash_ ^ bytes.size());
    for (size_t i = 0; i < bytes.size(); i += 8) {
        uint64_t word = 0;
        std::memcpy(&word, bytes.data() + i, std::min<size_t>(8, bytes.size() - i));
        hash_ = MixBits(hash_ * 0x9e3779b97f4a7c15ull + word);
    }
}

std::string SceneHash(const std::string &scenePath) {
    ContentHash hash;
    VisitFiles(scenePath, [&](const std::string &, const std::string &content) { hash.Add(content); });
    return hash.Hex();
}

std::map<std::string, std::string> FileHashes(const std::string &scenePath, const std::set<std::string> &outputs) {
    std::map<std::string, std::string> hashes;
    const std::filesystem::path folder = std::filesystem::path(scenePath).parent_path();
    VisitFiles(
        scenePath,
        [&](const std::string &path, const std::string &content) {
            const std::string name =
                folder.empty() ? path : std::filesystem::path(path).lexically_proximate(folder).string();
            hashes[name] = ContentHash(content).Hex();
        },
        outputs);
    return hashes;
}

}  // namespace pbrt
