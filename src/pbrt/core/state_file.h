#pragma once
#include <map>
#include <string>
#include <string_view>

#include "pbrt/core/state_io.h"

namespace pbrt {

/// A file of named byte sections. Incomplete or damaged files are detected by the length in the header and a CRC-32 of
/// all preceding bytes at the end.
class StateFile {
  public:
    /// Reads the file. `kind`: expected kind for messages, such as "checkpoint". Throws UserError if it is unreadable,
    /// truncated, damaged, of another kind, or of another layout version.
    StateFile(const std::string &path, const std::string &kind);
    StateFile(const StateFile &) = delete;  // sections refer to the content
    StateFile &operator=(const StateFile &) = delete;

    const std::string &Path() const { return path_; }
    /// Throws UserError if the section does not exist. The bytes live as long as this object.
    std::string_view Section(const std::string &name) const {
        const auto it = sections_.find(name);
        if (it == sections_.end()) throw UserError("{}: has no section \"{}\".", path_, name);
        return it->second;
    }

  private:
    std::string path_, content_;
    std::map<std::string, std::string_view> sections_;
};

/// Writes atomically by WriteFile: the name always refers to a complete old or new file.
void WriteStateFile(const std::string &path, const std::string &kind,
                    const std::map<std::string, const StateWriter *> &sections);

}  // namespace pbrt
