#pragma once
#include <cstdint>
#include <string>

namespace pbrt::lab {

/// 64 bits over everything that was added, in order.
class ContentHash {
  public:
    void Add(const std::string &bytes);
    uint64_t Value() const { return hash_; }
    std::string Hex() const;  ///< 16 digits

  private:
    uint64_t hash_ = 0x6c6967687461620aull;
};

/// Over the scene file and every file it names, directly or through files it includes: whatever a quoted string
/// resolves to as the renderer would resolve it. Comments count; names and dates of files do not. Throws UserError if
/// the scene cannot be read.
std::string SceneHash(const std::string &scenePath);

}  // namespace pbrt::lab
