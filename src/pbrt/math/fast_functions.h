#pragma once
#include <bit>
#include <cstdint>

#include "pbrt/math/vec.h"

namespace pbrt {

// Branchless polynomial functions for hot code, vectorised over wavelengths. Polynomials interpolate at Chebyshev
// nodes; tests check the error bounds over all arguments.

struct SineCosine {
    Float sin, cos;
};

/// Of the angle Pi / 4 * x, |x| <= 1. Errors at most 1e-7, relative for the sine.
inline SineCosine SineCosineOfEighth(Float x) {
    const Float s = x * x;
    return {x * (0.78539816f + s * (-0.080745434f + s * (2.4900068e-3f + s * -3.5954291e-5f))),
            1 + s * (-0.30842514f + s * (0.015854325f + s * (-3.2593859e-4f + s * 3.5297971e-6f)))};
}

/// Of the angle 2 Pi u, 0 <= u <= 1. Errors at most 1e-7.
inline SineCosine SineCosineOfTurn(Float u) {
    // Nearest quarter turn and the rest in eighths of a turn, exact in floating point.
    const Float quarters = 4 * u;
    const int nearest = int(quarters + Float(0.5));
    const SineCosine rest = SineCosineOfEighth(2 * (quarters - Float(nearest)));
    const bool swapped = nearest & 1;
    const Float sin = swapped ? rest.cos : rest.sin, cos = swapped ? rest.sin : rest.cos;
    return {nearest & 2 ? -sin : sin, (nearest + 1) & 2 ? -cos : cos};
}

/// std::atan2(y, x) for y >= 0, in [0, Pi]. Relative error at most 3e-7.
inline Float ArcTangent2(Float y, Float x) {
    const Float across = std::abs(x);
    const Float larger = std::max(y, across), t = larger > 0 ? std::min(y, across) / larger : 0;
    const Float s = t * t, s2 = s * s, s4 = s2 * s2;
    const Float low = (1 + s * -0.33333036f) + s2 * (0.19991872f + s * -0.14197798f);
    const Float high = (0.10618371f + s * -0.074568548f) + s2 * (0.042137624f + s * -0.015731249f);
    const Float small = t * (low + s4 * (high + s4 * 2.7662836e-3f));
    const Float acute = y > across ? Pi / 2 - small : small;
    return x < 0 ? Pi - acute : acute;
}

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
inline Float DepthThatTakes(Float u) { return Float(-std::log(1.0 - double(u))); }

}  // namespace pbrt
