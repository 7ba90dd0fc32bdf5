#pragma once
#include <filesystem>
#include <string>
#include <string_view>

#include "pbrt/core/memory.h"

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

/// Whether there is anything of that name that can be asked about; false for names that no file can have.
bool FileExists(const std::string &path);

/// ".exr" of "a/B.EXR": the extension in small letters.
std::string LowerExtension(const std::string &path);

/// Whether something that is not a regular file may be read, too. A device such as /dev/zero never may: it has no end.
enum class ReadFrom { Files, FilesAndPipes };

/// The whole content; gzip content is decompressed whatever the name. Throws UserError (no location) if unreadable, or
/// if it is larger than the memory that `available` says is left; a small file may be decompressed to any size.
std::string ReadFileContents(const std::string &path, ReadFrom from = ReadFrom::Files,
                             double (*available)() = AvailableMemory);

/// Everything the programs write goes through this function. Afterwards the file holds `content` and is on the disk; if
/// anything goes wrong, UserError (no location) is thrown and the file is as it was before. For that the content goes
/// to a temporary file in the same folder, which is flushed to the disk and then takes the file's name.
/// A symbolic link stays and what it leads to is replaced; an existing file's permissions stay. A pipe or device is
/// written to directly.
void WriteFile(const std::string &path, std::string_view content);

/// Throws the UserError that WriteFile(path, ...) would throw now, as far as that can be known before writing: the
/// folder is missing or read-only, the name is too long, is that of a folder, ... Leaves nothing behind.
void CheckWritable(const std::string &path);

}  // namespace pbrt
