#pragma once
#include <string>

#include "pbrt/core/error.h"

namespace pbrt {

/// Upper bound of this process's memory, in bytes: the machine's memory, ulimit -v, or control group limit.
double UsableMemory();

/// Bytes this process can still allocate, from the machine's free memory and the process limits.
double AvailableMemory();

/// "240 MB", "23 GB": two digits.
std::string BytesText(double bytes);

/// Throws UserError "`what` needs about 240 GB of memory, but this process can use 23 GB." if `bytes` exceed
/// UsableMemory(). To be called before allocations of user-controlled size.
void RequireMemory(double bytes, const std::string &what, const FileLoc &loc);

/// Message for a std::bad_alloc during `phase` ("" if unknown).
std::string OutOfMemoryText(const std::string &phase);

/// Limits this process's own writable mappings to `bytes`: further allocations fail. A lower existing limit stays.
void LimitMemory(double bytes);

}  // namespace pbrt
