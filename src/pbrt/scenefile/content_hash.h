#pragma once
#include <cstdint>
#include <map>
#include <set>
#include <string>

namespace pbrt {

/// A 64-bit hash of everything that was added, in order.
class ContentHash {
  public:
    void Add(const std::string &bytes);
    uint64_t Value() const { return hash_; }
    std::string Hex() const;  ///< 16 digits

  private:
    uint64_t hash_ = 0x6c6967687461620aull;
};

/// A hash of the scene file and of every file that it names, directly or through included files: whatever file a quoted
/// string names, resolved as the renderer does. Comments count; names and dates of files do not. Throws UserError if
/// the scene cannot be read.
std::string SceneHash(const std::string &scenePath);

/// A hash of each of these files. The keys are their names, relative to the folder of the scene file, so
/// that a scene may be moved with all its files. `outputs`: names in the scene that are of files to be written.
std::map<std::string, std::string> FileHashes(const std::string &scenePath, const std::set<std::string> &outputs);

}  // namespace pbrt
