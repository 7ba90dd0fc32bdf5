#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <mutex>
#include <optional>
#include <set>

#include "pbrt/core/error.h"
#include "pbrt/core/files.h"

namespace pbrt {
namespace {

struct TemporaryPaths {
    std::mutex mutex;
    std::multiset<std::string> paths;
};

/// Leaked: a signal may come during process exit.
TemporaryPaths &Registered() {
    static auto *registry = new TemporaryPaths;
    return *registry;
}

namespace fs = std::filesystem;

[[noreturn]] void Fail(const std::string &path, int error) {
    throw UserError("{}: cannot be written: {}.", path, std::strerror(error));
}

/// The file at the end of all symbolic links.
struct Target {
    std::string shown;  ///< user's name, for messages
    fs::path path;
    bool exists = false;
    bool inPlace = false;   ///< a pipe, device or open file of this process: not replaceable
    struct stat status {};  ///< of an existing file
};

Target FindTarget(const std::string &name) {
    Target target{.shown = name, .path = name};
    if (target.path.filename().empty()) throw UserError("\"{}\" is not the name of a file.", name);
    target.exists = stat(name.c_str(), &target.status) == 0;
    if (!target.exists && errno != ENOENT) Fail(name, errno);
    if (target.exists) {
        if (S_ISDIR(target.status.st_mode)) throw UserError("{}: is a folder.", name);
        // Rejected, although root or the folder's owner could replace a write-protected file.
        if ((target.status.st_mode & 0222) == 0 || faccessat(AT_FDCWD, name.c_str(), W_OK, AT_EACCESS) != 0)
            throw UserError("{}: is write-protected.", name);
        target.inPlace = !S_ISREG(target.status.st_mode);
    }
    std::error_code failed;
    for (int links = 0; !target.inPlace && fs::is_symlink(target.path, failed); ++links) {
        if (links == 40) Fail(name, ELOOP);
        // Kernel links to open files, such as the target of /dev/stdout.
        if (target.path.string().starts_with("/proc/")) {
            target.inPlace = true;
            target.path = name;
            break;
        }
        const fs::path next = fs::read_symlink(target.path, failed);
        if (failed) Fail(name, failed.value());
        target.path = target.path.parent_path() / next;
    }
    return target;
}

using Pieces = std::vector<std::string_view>;

void WriteAll(int file, const Pieces &pieces, const std::string &shown) {
    for (std::string_view rest : pieces)
        while (!rest.empty()) {
            const ssize_t written = write(file, rest.data(), rest.size());
            if (written < 0 && errno == EINTR) continue;
            if (written < 0) Fail(shown, errno);
            rest.remove_prefix(written);
        }
}

void WriteInPlace(const Target &target, const Pieces &content) {
    const int file = open(target.path.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC | O_NOCTTY);
    if (file < 0) Fail(target.shown, errno);
    try {
        WriteAll(file, content, target.shown);
    } catch (...) {
        close(file);
        throw;
    }
    if (close(file) != 0) Fail(target.shown, errno);
}

/// Temporary file in the target's folder. TakePlace renames it to the target, else the destructor deletes it.
class TemporaryFile {
  public:
    explicit TemporaryFile(const Target &target) : target_(target) {
        folder_ = target.path.parent_path();
        if (folder_.empty()) folder_ = ".";
        std::error_code ignored;
        if (!fs::is_directory(folder_, ignored))
            throw UserError("{}: the folder {} does not exist.", target.shown, folder_.string());
        // Unique per thread and process; excludes the target's name, which could make it too long.
        static std::atomic<unsigned> count{0};
        do {
            path_ = folder_ / fmt::format(".pbrt-{}-{}.tmp", getpid(), count++);
            file_ = open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        } while (file_ < 0 && errno == EEXIST);
        if (file_ < 0 && (errno == EACCES || errno == EROFS || errno == EPERM))
            throw UserError("{}: the folder {} is not writable.", target.shown, folder_.string());
        if (file_ < 0) Fail(target.shown, errno);
        registered_.emplace(path_.string());
    }
    ~TemporaryFile() {
        if (file_ >= 0) close(file_);
        if (!renamed_) unlink(path_.c_str());
    }
    TemporaryFile(const TemporaryFile &) = delete;
    TemporaryFile &operator=(const TemporaryFile &) = delete;

    void Write(const Pieces &content) {
        WriteAll(file_, content, target_.shown);
        size_t bytes = 0;
        for (const std::string_view piece : content) bytes += piece.size();
        if (target_.exists) {
            // Best effort: only root may change the owner, and some file systems have no permissions.
            [[maybe_unused]] int kept = fchown(file_, target_.status.st_uid, target_.status.st_gid);
            kept = fchmod(file_, target_.status.st_mode & 0777);
        }
        int done = 0;
        do done = fsync(file_);
        while (done != 0 && errno == EINTR);
        // Some file systems cannot flush files (EINVAL, ENOTSUP); not an error here.
        if (done != 0 && errno != EINVAL && errno != ENOTSUP) Fail(target_.shown, errno);
        struct stat status {};
        if (fstat(file_, &status) != 0) Fail(target_.shown, errno);
        if (size_t(status.st_size) != bytes)
            throw UserError("{}: only {} of {} bytes were written.", target_.shown, status.st_size, bytes);
        const int closed = close(file_);
        file_ = -1;
        if (closed != 0) Fail(target_.shown, errno);
    }

    void TakePlace() {
        if (rename(path_.c_str(), target_.path.c_str()) != 0) Fail(target_.shown, errno);
        renamed_ = true;
        // The new name must reach the disk, too. Failure to flush the folder is an error only for EIO.
        const int folder = open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
        if (folder < 0) return;
        const int error = fsync(folder) == 0 ? 0 : errno;
        close(folder);
        if (error == EIO) Fail(target_.shown, error);
    }

  private:
    const Target &target_;
    fs::path folder_, path_;
    std::optional<Temporary> registered_;  ///< path_
    int file_ = -1;
    bool renamed_ = false;
};

}  // namespace

Temporary::Temporary(std::string path) : path_(std::move(path)) {
    TemporaryPaths &r = Registered();
    std::lock_guard lock(r.mutex);
    r.paths.insert(path_);
}

Temporary::~Temporary() {
    TemporaryPaths &r = Registered();
    std::lock_guard lock(r.mutex);
    r.paths.erase(r.paths.find(path_));
}

void RemoveTemporaries() {
    TemporaryPaths &r = Registered();
    r.mutex.lock();
    std::error_code ignored;
    for (const std::string &path : r.paths) std::filesystem::remove_all(path, ignored);
}

void WriteFile(const std::string &path, const Pieces &content) {
    // Exceeded file-size limits and pipes without reader give errors instead of ending the process.
    for (int number : {SIGXFSZ, SIGPIPE}) signal(number, SIG_IGN);
    const Target target = FindTarget(path);
    if (target.inPlace) return WriteInPlace(target, content);
    TemporaryFile file(target);
    file.Write(content);
    file.TakePlace();
}

void CheckWritable(const std::string &path) {
    const Target target = FindTarget(path);
    if (!target.inPlace) TemporaryFile file(target);
}

}  // namespace pbrt
