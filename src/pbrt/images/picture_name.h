#pragma once
#include <string>

#include "pbrt/core/error.h"

namespace pbrt {

/// Throws UserError unless the name of a rendered image ends in .exr, .png or .pfm (case-insensitive). CheckWritable
/// (core/files.h) tests whether the file can be written.
void CheckPictureName(const std::string &path, const FileLoc &loc);

/// Inserts a suffix before the extension: "out-more.exr" for "out.exr" and "-more".
std::string WithSuffix(const std::string &path, const std::string &suffix);

}  // namespace pbrt
