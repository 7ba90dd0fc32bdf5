#include "pbrt/core/files.h"

#include <unistd.h>
#include <zlib.h>

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
    gzbuffer(file.get(), 1 << 18);
    std::string content;
    uintmax_t size = std::filesystem::file_size(path, code);
    if (!code) content.reserve(size + 1);
    constexpr size_t kChunk = 1 << 18;
    for (;;) {
        size_t old = content.size();
        content.resize(old + kChunk);
        int got = gzread(file.get(), content.data() + old, kChunk);
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
