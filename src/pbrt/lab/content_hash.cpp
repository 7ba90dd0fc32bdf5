#include "pbrt/lab/content_hash.h"

#include <fmt/format.h>

#include <cstring>
#include <filesystem>
#include <set>
#include <vector>

#include "pbrt/core/error.h"
#include "pbrt/core/files.h"
#include "pbrt/math/rng.h"

namespace pbrt::lab {

namespace {

/// Quoted strings of a scene file, in order; comments are passed over.
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

bool IsSceneText(const std::string &name) { return name.ends_with(".pbrt") || name.ends_with(".pbrt.gz"); }

class SceneReader {
  public:
    explicit SceneReader(const std::string &scenePath) : files_(std::filesystem::path(scenePath).parent_path()) {}

    void Add(const std::string &path, bool isScene) {
        if (!seen_.insert(path).second) return;
        std::string content = ReadFileContents(path);
        hash_.Add(content);
        if (!isScene) return;
        for (const std::string &name : QuotedStrings(content)) {
            std::error_code none;
            std::string file = files_.Resolve(name);
            if (!name.empty() && std::filesystem::is_regular_file(file, none)) Add(file, IsSceneText(file));
        }
    }
    std::string Hex() const { return hash_.Hex(); }

  private:
    FileResolver files_;
    std::set<std::string> seen_;
    ContentHash hash_;
};

}  // namespace

void ContentHash::Add(const std::string &bytes) {
    hash_ = MixBits(hash_ ^ bytes.size());
    for (size_t i = 0; i < bytes.size(); i += 8) {
        uint64_t word = 0;
        std::memcpy(&word, bytes.data() + i, std::min<size_t>(8, bytes.size() - i));
        hash_ = MixBits(hash_ * 0x9e3779b97f4a7c15ull + word);
    }
}

std::string ContentHash::Hex() const { return fmt::format("{:016x}", hash_); }

std::string SceneHash(const std::string &scenePath) {
    SceneReader reader(scenePath);
    reader.Add(scenePath, true);
    return reader.Hex();
}

}  // namespace pbrt::lab
