#pragma once
#include "pbrt/math/vec.h"

namespace pbrt {

/// Gradient noise (Perlin 2002): 0 at whole coordinates, within [-1, 1], smooth, repeats every 256 units.
Float GradientNoise(const Point3 &p);
/// Its gradient.
Vector3 GradientNoiseSlope(const Point3 &p);

/// Octaves of noise added up, each 1.99 times as fine and `roughness` times as strong as the one before. Octaves finer
/// than the footprint (dpdx, dpdy: moves of p by one pixel step) fade out; a footprint of 0 keeps all of them.
struct NoiseOctaves {
    Float roughness = Float(0.5);
    int count = 8;

    /// Plain sum: mean 0.
    Float Signed(const Point3 &p, const Vector3 &dpdx, const Vector3 &dpdy) const;
    /// Sum of absolute values: creases where noise is 0. Octaves that fade out are replaced by their mean.
    Float Creased(const Point3 &p, const Vector3 &dpdx, const Vector3 &dpdy) const;
};

}  // namespace pbrt
