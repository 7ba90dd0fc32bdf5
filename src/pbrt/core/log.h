#pragma once
#include <string>

namespace pbrt {

/// Messages about the run (not about a scene-file location), to standard error.
enum class LogLevel { Quiet, Error, Warning, Info };

void SetLogLevel(LogLevel level);
LogLevel CurrentLogLevel();

/// Equal messages are printed once.
void LogWarning(const std::string &message);
void LogInfo(const std::string &message);

}  // namespace pbrt
