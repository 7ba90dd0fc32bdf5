#pragma once
#include <string>

#include "pbrt/core/error.h"

namespace pbrt {

/// Throws UserError unless the name of a rendered picture ends in .exr, .png or .pfm, in any letter case. Whether the
/// file can be written is for CheckWritable (core/files.h) to tell.
void CheckPictureName(const std::string &path, const FileLoc &loc);

}  // namespace pbrt
