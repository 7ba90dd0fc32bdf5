#pragma once
#include "pbrt/materials/material.h"

namespace pbrt {

/// A diffuse stand-in whose reflectance is what `material` reflects and transmits (an estimate), for --force-diffuse.
/// Interfaces and mixtures stay as they are: a mixture's operands are stand-ins themselves.
MaterialPtr ForceDiffuse(MaterialPtr material);

}  // namespace pbrt
