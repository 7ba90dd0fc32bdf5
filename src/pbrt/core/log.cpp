#include "pbrt/core/log.h"

#include <atomic>
#include <cstdio>
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

void LogError(const std::string &message) { Print(LogLevel::Error, "Error: ", message); }

void LogWarning(const std::string &message) {
    static std::mutex mutex;
    static std::set<std::string> seen;
    {
        std::lock_guard lock(mutex);
        if (!seen.insert(message).second) return;
    }
    Print(LogLevel::Warning, "Warning: ", message);
}

void LogInfo(const std::string &message) { Print(LogLevel::Info, "", message); }

}  // namespace pbrt
