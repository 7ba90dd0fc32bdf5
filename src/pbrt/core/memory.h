#pragma once
#include <string>

#include "pbrt/core/error.h"

namespace pbrt {

/// Bytes this process can have at most: the machine's memory, or less if the process (ulimit -v) or its control group
/// is limited.
double UsableMemory();

/// Bytes this process could take now in addition to what it has: what the machine has left, and what its limits leave.
double AvailableMemory();

/// "240 MB", "23 GB": two digits.
std::string BytesText(double bytes);

/// An error that says "`what` needs about 240 GB, but this process can use 23 GB." if it does. To be asked before
/// memory is allocated for something whose size the user chose.
void RequireMemory(double bytes, const std::string &what, const FileLoc &loc);

/// What to say of a std::bad_alloc during `phase` ("" if that is not known).
std::string OutOfMemoryText(const std::string &phase);

}  // namespace pbrt
