#pragma once
#include <memory>
#include <string>

#include "pbrt/bxdfs/measured.h"

namespace pbrt {

/// Reads a BRDF of the RGL material database (isotropic, or anisotropic over the whole circle). Throws UserError (no
/// location).
std::shared_ptr<const MeasuredBrdf> ReadMeasuredBrdf(const std::string &path);

}  // namespace pbrt
