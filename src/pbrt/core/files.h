#pragma once
#include <filesystem>
#include <string>

namespace pbrt {

/// Finds the files a scene names: absolute paths as they are; else relative to the directory of the top-level scene
/// file if it exists there; else relative to the working directory (pbrt-v4-format §11).
class FileResolver {
  public:
    FileResolver() = default;
    explicit FileResolver(std::filesystem::path sceneDirectory) : directory_(std::move(sceneDirectory)) {}
    std::string Resolve(const std::string &name) const;

  private:
    std::filesystem::path directory_;
};

/// The whole content; gzip content is decompressed whatever the name. Throws UserError (no location) if unreadable.
std::string ReadFileContents(const std::string &path);

/// Writes to a temporary name beside `path` and renames, so that a finished file is never lost to a half-written one.
/// `write` gets the temporary name (same extension as `path`); if it throws, the temporary file is removed.
template <class F>
void WriteThenRename(const std::string &path, F &&write);

/// Temporary name used by WriteThenRename.
std::string TemporaryNameFor(const std::string &path);

template <class F>
void WriteThenRename(const std::string &path, F &&write) {
    std::string temporary = TemporaryNameFor(path);
    try {
        write(temporary);
        std::filesystem::rename(temporary, path);
    } catch (...) {
        std::error_code ignored;
        std::filesystem::remove(temporary, ignored);
        throw;
    }
}

}  // namespace pbrt
