#include "pbrt/core/files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <memory>
#include <sstream>

namespace pbrt {

namespace {

// Opens a file for reading; throws UserError for kinds that may be endless. *size: bytes of a regular file, or 0.
int OpenForReading(const std::string &path, ReadFrom from, size_t *size) {
    // Without O_NONBLOCK, opening a pipe blocks until a writer connects.
    const int flags = from == ReadFrom::Files ? O_RDONLY | O_CLOEXEC | O_NONBLOCK : O_RDONLY | O_CLOEXEC;
    const int file = open(path.c_str(), flags);
    if (file < 0) throw UserError("{}: {}.", path, std::strerror(errno));
    struct stat status {};
    const bool known = fstat(file, &status) == 0;
    const bool pipe = S_ISFIFO(status.st_mode) || S_ISSOCK(status.st_mode) || isatty(file) == 1;
    const char *refusal = nullptr;
    if (!known) refusal = "the kind of this file cannot be determined";
    else if (S_ISDIR(status.st_mode)) refusal = "is a directory";
    else if (pipe && from == ReadFrom::Files) refusal = "is a pipe or a terminal, not a file";
    else if (!pipe && !S_ISREG(status.st_mode)) refusal = "is a device, not a file";
    if (refusal) {
        close(file);
        throw UserError("{}: {}.", path, refusal);
    }
    *size = S_ISREG(status.st_mode) ? status.st_size : 0;
    return file;
}

// Reserves `bytes` for `content`. They must fit into the available memory beside the old buffer.
void Grow(std::string &content, size_t bytes, const std::string &path, double (*available)()) {
    // Smaller sizes skip the check, which is a system call.
    constexpr size_t kSmall = 1 << 24;
    if (const double left = bytes > kSmall ? available() : 0; bytes > kSmall && double(bytes) > left)
        throw UserError(
            "{}: too large to read: after {} of content, reading on needs {} of "
            "memory, but {} are left for this process.",
            path, BytesText(double(content.size())), BytesText(double(bytes)), BytesText(left));
    content.reserve(bytes);
}

}  // namespace

std::string ReadFileContents(const std::string &path, ReadFrom from, double (*available)()) {
    size_t size = 0;
    const int descriptor = OpenForReading(path, from, &size);
    // gzread passes plain content through unchanged.
    std::unique_ptr<gzFile_s, int (*)(gzFile)> file(gzdopen(descriptor, "rb"), gzclose);
    if (!file) {
        close(descriptor);
        throw UserError("{}: {}.", path, std::strerror(ENOMEM));
    }
    // Scenes may have thousands of small files, hence no larger than the file.
    constexpr size_t kMax = 1 << 18, kMin = 1 << 12;
    if (size == 0) size = kMax;  // a pipe or a virtual file of the kernel
    gzbuffer(file.get(), unsigned(std::clamp(size, kMin, kMax)));
    std::string content;
    Grow(content, size + kMin, path, available);
    for (;;) {
        size_t old = content.size();
        if (content.capacity() == old) Grow(content, 2 * old, path, available);
        const size_t chunk = std::min(content.capacity() - old, kMax);
        content.resize(old + chunk);
        int got = gzread(file.get(), content.data() + old, unsigned(chunk));
        if (got < 0) {
            int error = 0;
            throw UserError("{}: {}.", path, gzerror(file.get(), &error));
        }
        content.resize(old + got);
        if (got == 0) break;
    }
    if (gzclose(file.release()) == Z_BUF_ERROR) throw UserError("{}: the compressed data ends too early.", path);
    return content;
}

std::vector<Float> ReadNumberFile(const std::string &path) {
    std::istringstream lines(ReadFileContents(path));
    std::vector<Float> numbers;
    int count = 0;
    for (std::string line; std::getline(lines, line);) {
        ++count;
        std::istringstream words(line.substr(0, line.find('#')));
        for (std::string word; words >> word;) {
            char *after = nullptr;
            const Float value = std::strtof(word.c_str(), &after);
            if (after != word.c_str() + word.size() || !std::isfinite(value))
                throw UserError("{}:{}: expected a number; this file may contain only finite numbers and # comments.",
                                path, count);
            numbers.push_back(value);
        }
    }
    return numbers;
}

}  // namespace pbrt
