#pragma once
#include <string>

#include "pbrt/core/error.h"

namespace pbrt {

/// Throws UserError unless the name of a rendered picture ends in .exr, .png or .pfm, in any letter case. CheckWritable
/// (core/files.h) checks whether the file can be written.
void CheckPictureName(const std::string &path, const FileLoc &loc);

/// The name of a picture beside another one: "out-more.exr" for "out.exr" and "-more".
std::string WithSuffix(const std::string &path, const std::string &suffix);

}  // namespace pbrt
