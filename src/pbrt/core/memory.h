#pragma once
#include <string>

#include "pbrt/core/error.h"

namespace pbrt {

/// The most bytes that this process can use: the machine's memory, or less if the process (ulimit -v) or its control
/// group is limited.
double UsableMemory();

/// Bytes that this process can use in addition to those it has: the smaller of what the machine has left and what the
/// limits of the process leave.
double AvailableMemory();

/// "240 MB", "23 GB": two digits.
std::string BytesText(double bytes);

/// Throws UserError "`what` needs about 240 GB of memory, but this process can use 23 GB." if `bytes` exceed
/// UsableMemory(). To be called before memory is allocated for something whose size the user chose.
void RequireMemory(double bytes, const std::string &what, const FileLoc &loc);

/// The message for a std::bad_alloc during `phase` ("" if the phase is not known).
std::string OutOfMemoryText(const std::string &phase);

/// From here on this process can use at most so many bytes (its own mappings that can be written): allocating more
/// fails. A smaller limit that it has already stays.
void LimitMemory(double bytes);

}  // namespace pbrt
