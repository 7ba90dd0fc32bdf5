#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "pbrt/core/float.h"
#include "pbrt/core/memory.h"

namespace pbrt {

/// Finds the files that a scene names. An absolute path is used as it is. A relative one starts from the directory of
/// the top-level scene file if the file exists there, else from the working directory (pbrt-v4-format §11).
class FileResolver {
  public:
    FileResolver() = default;
    explicit FileResolver(std::filesystem::path sceneDirectory) : directory_(std::move(sceneDirectory)) {}
    std::string Resolve(const std::string &name) const;

  private:
    std::filesystem::path directory_;
};

/// True if a file, folder or device of that name exists; false also for names that no file can have.
bool FileExists(const std::string &path);

/// ".exr" of "a/B.EXR": the extension in small letters.
std::string LowerExtension(const std::string &path);

/// Which kinds of files may be read: only regular ones, or pipes, sockets and terminals as well. Devices such as
/// /dev/zero are never read, because they have no end.
enum class ReadFrom { Files, FilesAndPipes };

/// Returns the whole content; gzip data are decompressed whatever the file is called. Throws UserError (no location) if
/// the file cannot be read, or if its content (which may decompress to any size) needs more memory than `available()`
/// returns.
std::string ReadFileContents(const std::string &path, ReadFrom from = ReadFrom::Files,
                             double (*available)() = AvailableMemory);

/// Everything the programs write goes through this function. Afterwards the file holds `content` and is on the disk; if
/// anything goes wrong, UserError (no location) is thrown and the file is as it was before. To this end the content is
/// written to a temporary file in the same folder, which is flushed to the disk and then takes the file's name. A
/// symbolic link is kept and its target is replaced; the permissions of an existing file are kept. Pipes and devices
/// are written to directly.
void WriteFile(const std::string &path, std::string_view content);

/// Throws the UserError that WriteFile(path, ...) would throw now, as far as that can be known before writing: because
/// the folder is missing or read-only, or because the name is too long or that of a folder, for example. Leaves nothing
/// behind.
void CheckWritable(const std::string &path);

/// The same for a content in pieces, which are written one after the other.
void WriteFile(const std::string &path, const std::vector<std::string_view> &pieces);

/// Reads a file of numbers separated by white space; '#' to the end of the line is a comment (pbrt-v4-format §15:
/// spectrum and lens files). Throws UserError (no location) if it is unreadable or holds anything else.
std::vector<Float> ReadNumberFile(const std::string &path);

}  // namespace pbrt
