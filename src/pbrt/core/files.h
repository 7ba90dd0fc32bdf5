#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "pbrt/core/float.h"
#include "pbrt/core/memory.h"

namespace pbrt {

/// True if a file, folder or device of that name exists; false for invalid names.
inline bool FileExists(const std::string &path) {
    std::error_code none;
    return std::filesystem::exists(path, none);
}

/// Resolves file names of a scene. Absolute paths are kept. Relative ones start from the directory of the top-level
/// scene file if the file exists there, else from the working directory (pbrt-v4-format §11).
class FileResolver {
  public:
    FileResolver() = default;
    explicit FileResolver(std::filesystem::path sceneDirectory) : directory_(std::move(sceneDirectory)) {}
    std::string Resolve(const std::string &name) const {
        std::filesystem::path path(name);
        if (path.is_absolute() || directory_.empty()) return name;
        std::filesystem::path beside = directory_ / path;
        return FileExists(beside.string()) ? beside.string() : name;
    }

  private:
    std::filesystem::path directory_;
};

/// True if both names lead to the same file, which need not exist. False for pipes and devices.
inline bool IsSameFile(const std::string &a, const std::string &b) {
    namespace fs = std::filesystem;
    std::error_code none;
    if (FileExists(a) || FileExists(b)) return fs::is_regular_file(a, none) && fs::equivalent(a, b, none);
    const auto target = [&](const std::string &name) { return fs::weakly_canonical(fs::absolute(name, none), none); };
    return !target(a).empty() && target(a) == target(b);
}

/// Replaces A-Z by a-z.
inline std::string Lower(std::string text) {
    for (char &c : text)
        if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
    return text;
}
/// Lower-case extension: ".exr" of "a/B.EXR".
inline std::string LowerExtension(const std::string &path) {
    return Lower(std::filesystem::path(path).extension().string());
}

/// Readable kinds of files: regular only, or also pipes, sockets and terminals. Devices such as /dev/zero are never
/// read, because they have no end.
enum class ReadFrom { Files, FilesAndPipes };

/// Returns the whole content, decompressing gzip data regardless of the file name. Throws UserError (no location) if
/// the file is unreadable or its content needs more memory than `available()` returns.
std::string ReadFileContents(const std::string &path, ReadFrom from = ReadFrom::Files,
                             double (*available)() = AvailableMemory);

/// Replaces the file atomically; all output goes through these functions. On return the content is on the disk; on
/// failure UserError (no location) is thrown and the file is unchanged. Writes and flushes a temporary file in the same
/// folder, then renames it. The target of a symbolic link is replaced, permissions are kept, pipes and devices are
/// written directly.
void WriteFile(const std::string &path, const std::vector<std::string_view> &pieces);
inline void WriteFile(const std::string &path, std::string_view content) { WriteFile(path, std::vector{content}); }

/// Throws the UserError that WriteFile would throw for the path, as far as it can be tested in advance: missing or
/// read-only folder, name too long or naming a folder. Leaves no files behind.
void CheckWritable(const std::string &path);

/// Reads numbers separated by white space; '#' starts a comment (pbrt-v4-format §15: spectrum and lens files). Throws
/// UserError (no location) if the file is unreadable or holds anything else.
std::vector<Float> ReadNumberFile(const std::string &path);

/// Registers a file or folder that RemoveTemporaries deletes if a signal ends the process during this object's
/// lifetime. The destructor deletes nothing.
class Temporary {
  public:
    explicit Temporary(std::string path);
    ~Temporary();
    Temporary(const Temporary &) = delete;
    Temporary &operator=(const Temporary &) = delete;

  private:
    std::string path_;
};

/// Deletes all registered files, and folders with their content. Only before process exit: afterwards, creating or
/// destroying a Temporary blocks forever.
void RemoveTemporaries();

}  // namespace pbrt
