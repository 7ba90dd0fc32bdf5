#pragma once
#include <map>
#include <string>
#include <string_view>

#include "pbrt/core/state_io.h"

namespace pbrt {

/// A file of named sections of bytes that is either whole or refused: its head holds its length, its end a checksum of
/// everything before (CRC-32).
class StateFile {
  public:
    /// Reads all of it. `kind`: what the file should be, such as "checkpoint". Throws UserError if it cannot be read,
    /// is cut off or damaged, is of another kind, or was written by a program with another layout.
    StateFile(const std::string &path, const std::string &kind);
    StateFile(const StateFile &) = delete;  // sections refer to the content
    StateFile &operator=(const StateFile &) = delete;

    const std::string &Path() const { return path_; }
    bool Has(const std::string &section) const { return sections_.count(section) > 0; }
    /// Throws UserError if there is no such section. The bytes live as long as this object.
    std::string_view Section(const std::string &name) const;

  private:
    std::string path_, content_;
    std::map<std::string, std::string_view> sections_;
};

/// Writes such a file by WriteFile: whatever happens meanwhile, the name leads to the whole old file or to the whole
/// new one.
void WriteStateFile(const std::string &path, const std::string &kind,
                    const std::map<std::string, const StateWriter *> &sections);

}  // namespace pbrt
