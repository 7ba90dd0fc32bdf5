#pragma once
#include <string>
#include <utility>

#include <fmt/format.h>

namespace pbrt {

/// Messages about the run (not about a scene-file location), to standard error.
enum class LogLevel { Quiet, Error, Warning, Info };

void SetLogLevel(LogLevel level);
LogLevel CurrentLogLevel();

/// Flushes standard output at the end of a program with exit status `status`. If anything written to it was lost,
/// prints an error and returns 1 instead of 0.
int FinishOutput(int status);

/// Equal messages are printed once.
void LogWarning(const std::string &message);
void LogInfo(const std::string &message);
template <class... T>
void LogWarning(fmt::format_string<T...> format, T &&...values) {
    LogWarning(fmt::format(format, std::forward<T>(values)...));
}
template <class... T>
void LogInfo(fmt::format_string<T...> format, T &&...values) {
    LogInfo(fmt::format(format, std::forward<T>(values)...));
}

}  // namespace pbrt
