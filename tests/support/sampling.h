#pragma once
#include <bit>
#include <vector>

#include "pbrt/math/rng.h"
#include "pbrt/math/warps.h"

namespace pbrt::test {

/// Slow twin of DigitPermutations in one dimension.
inline Float AffineRadicalInverse(uint32_t base, uint64_t a, uint32_t multiplier, uint64_t seed) {
    double weight = 1, value = 0;
    for (uint64_t k = 1; weight > 0x1p-32; ++k, a /= base) {
        const uint64_t shift = (MixBits(seed + 0x9e3779b97f4a7c15ull * k) >> 32) * base >> 32;
        weight /= base;
        value += double((multiplier * (a % base) + shift) % base) * weight;
    }
    return std::min(Float(value), OneMinusEpsilon);
}

/// Directions within the cone cos(theta) >= cosThetaMax about +z.
inline Vector3 SampleUniformCone(const Point2 &u, Float cosThetaMax) {
    Float c = (1 - u.x) + u.x * cosThetaMax;
    return SphericalDirectionOfTurn(SafeSqrt(1 - c * c), c, u.y);
}
inline Float UniformConePdf(Float cosThetaMax) { return 1 / (2 * Pi * (1 - cosThetaMax)); }  ///< solid angle

inline Vector3 RandomDirection(Rng &rng) {
    Float z = 2 * rng.Uniform() - 1, phi = 2 * Pi * rng.Uniform();
    return SphericalDirection(SafeSqrt(1 - z * z), z, phi);
}

/// Uniform in the cube [-1, 1)^3.
inline Vector3 RandomVector(Rng &rng) {
    Float x = rng.Uniform(), y = rng.Uniform(), z = rng.Uniform();
    return {2 * x - 1, 2 * y - 1, 2 * z - 1};
}

/// True if each box holds one point, for every cut of the square into 2^a columns and into rows so that there are as
/// many boxes as points. Points are pairs of 32-bit fractions.
template <class Points>
bool IsNet(const Points &points) {
    const int m = std::countr_zero(points.size());
    for (int a = 0; a <= m; ++a) {
        std::vector<uint8_t> taken(points.size(), 0);
        for (const auto &[x, y] : points) {
            const uint64_t column = uint64_t(x) >> (32 - a), row = uint64_t(y) >> (32 - (m - a));
            if (taken[column << (m - a) | row]++) return false;
        }
    }
    return true;
}

}  // namespace pbrt::test
