#pragma once
#include "pbrt/math/vec.h"

namespace pbrt {

/// Gradient noise (Perlin 2002): 0 at integer coordinates, in [-1, 1], period 256.
Float GradientNoise(const Point3 &p);
Vector3 GradientNoiseSlope(const Point3 &p);  ///< its derivatives by x, y and z

/// Fractal sum of noise: each octave has 1.99 times the frequency and `roughness` times the amplitude of the previous.
/// Octaves finer than the footprint (dpdx, dpdy per pixel step) fade out; a zero footprint keeps all.
struct NoiseOctaves {
    Float roughness = Float(0.5);
    int count = 8;

    /// Plain sum of mean 0.
    Float Signed(const Point3 &p, const Vector3 &dpdx, const Vector3 &dpdy) const;
    /// Sum of absolute values (turbulence). Faded octaves are replaced by their mean.
    Float Creased(const Point3 &p, const Vector3 &dpdx, const Vector3 &dpdy) const;
};

}  // namespace pbrt
