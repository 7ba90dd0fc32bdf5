#pragma once
#include <string>

#include "pbrt/core/error.h"

namespace pbrt {

/// Upper bound of this process's memory, in bytes: the machine's memory, ulimit -v, or control group limit.
double UsableMemory();

/// Bytes this process can still allocate, from the machine's free memory and the process limits.
double AvailableMemory();

/// "240 MB", "23 GB": two digits.
inline std::string BytesText(double bytes) {
    const char *unit = "MB";
    double value = bytes / 1e6;
    for (const char *larger : {"GB", "TB", "PB"}) {
        if (value < 999.5) break;
        value /= 1000;
        unit = larger;
    }
    return value < 9.95 ? fmt::format("{:.1f} {}", value, unit) : fmt::format("{:.0f} {}", value, unit);
}

/// Throws UserError "`what` needs about 240 GB of memory, but this process can use 23 GB." if `bytes` exceed
/// UsableMemory(). To be called before allocations of user-controlled size.
inline void RequireMemory(double bytes, const std::string &what, const FileLoc &loc) {
    const double usable = UsableMemory();
    if (bytes > usable)
        throw UserError(loc, "{} needs about {} of memory, but this process can use {}.", what, BytesText(bytes),
                        BytesText(usable));
}

/// Message for a std::bad_alloc during `phase` ("" if unknown).
std::string OutOfMemoryText(const std::string &phase);

/// Limits this process's own writable mappings to `bytes`: further allocations fail. A lower existing limit stays.
void LimitMemory(double bytes);

}  // namespace pbrt
