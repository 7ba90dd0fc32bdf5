#include "pbrt/core/log.h"

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <mutex>
#include <set>

namespace pbrt {
namespace {
std::atomic<LogLevel> currentLevel{LogLevel::Info};

void Print(LogLevel level, const char *prefix, const std::string &message) {
    if (level > currentLevel.load()) return;
    std::fprintf(stderr, "%s%s\n", prefix, message.c_str());
}
}  // namespace

void SetLogLevel(LogLevel level) { currentLevel = level; }
LogLevel CurrentLogLevel() { return currentLevel; }

int FinishOutput(int status) {
    errno = 0;
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return status;
    std::fprintf(stderr, "Error: the standard output cannot be written%s%s.\n", errno ? ": " : "",
                 errno ? std::strerror(errno) : "");
    return status ? status : 1;
}

void LogWarning(const std::string &message) {
    // Leaked: detached threads (LiveViewer) may warn during process exit.
    static std::mutex &mutex = *new std::mutex;
    static std::set<std::string> &seen = *new std::set<std::string>;
    {
        std::lock_guard lock(mutex);
        if (!seen.insert(message).second) return;
    }
    Print(LogLevel::Warning, "Warning: ", message);
}

void LogInfo(const std::string &message) { Print(LogLevel::Info, "", message); }

}  // namespace pbrt
