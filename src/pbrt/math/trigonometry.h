#pragma once
#include "pbrt/math/vec.h"

namespace pbrt {

// Branchless polynomial trigonometry for hot code. Polynomials interpolate at Chebyshev nodes; tests check the error
// bounds over all arguments.

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
    const int nearest = static_cast<int>(quarters + Float(0.5));
    const SineCosine rest = SineCosineOfEighth(2 * (quarters - static_cast<Float>(nearest)));
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

}  // namespace pbrt
