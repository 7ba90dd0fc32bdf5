#pragma once
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "pbrt/math/vec.h"

namespace pbrt {

// Branchless inline exponentials that vectorise over four wavelengths. Polynomials interpolate at Chebyshev nodes;
// tests check the error bounds.

/// exp(-x) for x >= 0, which may be infinite. Relative error at most 2e-7; 0 where the value is below 2^-125.
inline Float ExpOfMinus(Float x) {
    constexpr Float kMax = 86.6f, kLog2e = 1.44269504f, kLn2High = 0.693359375f, kLn2Low = -2.12194440e-4f;
    const Float limited = std::min(x, kMax);
    // 2^-n exp(r), |r| <= ln 2 / 2. Adding 3 * 2^22 rounds to an integer in the low bits.
    constexpr Float kRound = 12582912;
    const Float shifted = limited * kLog2e + kRound, n = shifted - kRound;
    const Float r = (n * kLn2High - limited) + n * kLn2Low;
    const Float p =
        1 + r * (1.000000038f +
                 r * (0.500000005f + r * (0.166664155f + r * (0.041666353f + r * (0.008375126f + r * 0.001394111f)))));
    const auto scale = std::bit_cast<Float>((127u - (std::bit_cast<uint32_t>(shifted) & 0xffu)) << 23);
    return x > kMax ? 0 : p * scale;
}

/// -log(1 - u) for u = 0 or in [2^-32, 1]: optical depth sampled from u. Relative error at most 5e-7; smaller u would
/// need log1p, which is slower.
inline Float DepthThatTakes(Float u) { return static_cast<Float>(-std::log(1.0 - static_cast<double>(u))); }

}  // namespace pbrt
