#pragma once
#include <fmt/format.h>

#include <cstdint>
#include <map>
#include <set>
#include <string>

namespace pbrt {

class ContentHash {
  public:
    ContentHash() = default;
    explicit ContentHash(const std::string &bytes) { Add(bytes); }
    void Add(const std::string &bytes);
    std::string Hex() const { return fmt::format("{:016x}", hash_); }  ///< 16 digits

  private:
    uint64_t hash_ = 0x6c6967687461620aull;
};

/// Hash of the scene file and of all files named by its quoted strings, directly or through included files, resolved as
/// the renderer does. Includes comments, excludes file names and dates. Throws UserError if the scene cannot be read.
std::string SceneHash(const std::string &scenePath);

/// Hash per file, keyed by name relative to the scene file's folder, so that a scene may be moved. `outputs`: names in
/// the scene that refer to output files.
std::map<std::string, std::string> FileHashes(const std::string &scenePath, const std::set<std::string> &outputs);

}  // namespace pbrt
