#pragma once
#include "pbrt/materials/material.h"

namespace pbrt {

/// Diffuse replacement with the estimated reflectance and transmittance of `material`, for --force-diffuse. Interfaces
/// and mixtures are kept; a mixture's operands are replaced themselves.
MaterialPtr ForceDiffuse(MaterialPtr material);

}  // namespace pbrt
