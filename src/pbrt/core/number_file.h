#pragma once
#include <string>
#include <vector>

#include "pbrt/core/float.h"

namespace pbrt {

/// Reads a file of numbers separated by white space; '#' to the end of the line is a comment (pbrt-v4-format §15:
/// spectrum and lens files). Throws UserError (no location) if it is unreadable or holds anything else.
std::vector<Float> ReadNumberFile(const std::string &path);

}  // namespace pbrt
