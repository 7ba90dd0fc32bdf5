#include "pbrt/core/files.h"

#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>

#include "pbrt/core/error.h"

namespace pbrt {

std::string FileResolver::Resolve(const std::string &name) const {
    std::filesystem::path path(name);
    if (path.is_absolute() || directory_.empty()) return name;
    std::filesystem::path beside = directory_ / path;
    std::error_code ignored;
    return std::filesystem::exists(beside, ignored) ? beside.string() : name;
}

std::string ReadFileContents(const std::string &path) {
    std::error_code code;
    if (std::filesystem::is_directory(path, code)) throw UserError(fmt::format("{}: is a directory.", path));
    // gzread passes plain content through unchanged.
    errno = 0;
    std::unique_ptr<gzFile_s, int (*)(gzFile)> file(gzopen(path.c_str(), "rb"), gzclose);
    if (!file) throw UserError(fmt::format("{}: {}.", path, std::strerror(errno ? errno : ENOMEM)));
    // Scenes have thousands of small files: no more memory is touched than they need.
    constexpr size_t kMost = 1 << 18, kLeast = 1 << 12;
    uintmax_t size = std::filesystem::file_size(path, code);
    if (code) size = kMost;
    gzbuffer(file.get(), static_cast<unsigned>(std::clamp<uintmax_t>(size, kLeast, kMost)));
    std::string content;
    content.reserve(size + kLeast);
    for (;;) {
        size_t old = content.size();
        const size_t chunk = std::clamp<size_t>(content.capacity() - old, kLeast, kMost);
        content.resize(old + chunk);
        int got = gzread(file.get(), content.data() + old, static_cast<unsigned>(chunk));
        if (got < 0) {
            int error = 0;
            throw UserError(fmt::format("{}: {}.", path, gzerror(file.get(), &error)));
        }
        content.resize(old + static_cast<size_t>(got));
        if (got == 0) break;
    }
    int closed = gzclose(file.release());
    if (closed == Z_BUF_ERROR) throw UserError(fmt::format("{}: the compressed data ends too early.", path));
    return content;
}

std::string TemporaryNameFor(const std::string &path) {
    std::filesystem::path p(path);
    std::filesystem::path name = p.parent_path() / fmt::format(".{}.{}{}", p.stem().string(), getpid(), p.extension().string());
    return name.string();
}

}  // namespace pbrt
