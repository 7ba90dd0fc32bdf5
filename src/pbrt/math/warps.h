#pragma once
#include "pbrt/math/fast_functions.h"
#include "pbrt/math/vec.h"

namespace pbrt {

// Maps from the unit square with their densities. Directions have z up.

/// Concentric map to the unit disk (Shirley and Chiu 1997). The outline of the square with half side |r| maps to the
/// circle of radius |r|, each side to a quarter; the position on the side, in [-1, 1], times Pi / 4 is the angle from
/// its middle. A negative r means the opposite side. Density 1/Pi by area.
inline Point2 SampleUniformDiskConcentric(const Point2 &u) {
    const Point2 at = Float(2) * u - Float(1);
    const bool onVerticalSide = std::abs(at.x) > std::abs(at.y);
    const Float r = onVerticalSide ? at.x : at.y;
    if (r == 0) return {0, 0};
    const SineCosine angle = SineCosineOfEighth((onVerticalSide ? at.y : at.x) / r);
    return r * (onVerticalSide ? Point2(angle.cos, angle.sin) : Point2(angle.sin, angle.cos));
}

/// Unit vector at polar angle theta from +z and azimuth 2 Pi u from +x.
inline Vector3 SphericalDirectionOfTurn(Float sinTheta, Float cosTheta, Float u) {
    const SineCosine phi = SineCosineOfTurn(u);
    return {sinTheta * phi.cos, sinTheta * phi.sin, cosTheta};
}

inline Vector3 SampleUniformHemisphere(const Point2 &u) {
    Float z = u.x;
    return SphericalDirectionOfTurn(SafeSqrt(1 - z * z), z, u.y);
}
constexpr Float UniformHemispherePdf() { return Inv2Pi; }  ///< solid angle

inline Vector3 SampleUniformSphere(const Point2 &u) {
    Float z = 1 - 2 * u.x;
    return SphericalDirectionOfTurn(SafeSqrt(1 - z * z), z, u.y);
}
constexpr Float UniformSpherePdf() { return Inv4Pi; }  ///< solid angle

inline Vector3 SampleCosineHemisphere(const Point2 &u) {
    Point2 d = SampleUniformDiskConcentric(u);
    return {d.x, d.y, SafeSqrt(1 - d.x * d.x - d.y * d.y)};
}
constexpr Float CosineHemispherePdf(Float cosTheta) { return cosTheta * InvPi; }  ///< solid angle

/// Barycentric coordinates, uniform by area (Heitz 2019, low distortion).
inline Vector3 SampleUniformTriangle(const Point2 &u) {
    Float b0, b1;
    if (u.x < u.y) {
        b0 = u.x / 2;
        b1 = u.y - b0;
    } else {
        b1 = u.y / 2;
        b0 = u.x - b1;
    }
    return {b0, b1, 1 - b0 - b1};
}

/// Samples [0, 1) proportionally to Lerp(x, a, b); a, b >= 0; uniform if both are 0.
inline Float SampleLinear(Float u, Float a, Float b) {
    if (!(a + b > 0)) return u;
    if (u == 0 && a == 0) return 0;
    Float x = u * (a + b) / (a + std::sqrt(Lerp(u, a * a, b * b)));
    return std::min(x, OneMinusEpsilon);
}

/// Samples the unit square proportionally to the bilinear interpolation of w = {w00, w10, w01, w11} (x first). The
/// marginal in y is linear between half the sums of the lower and upper corners; the conditional in x is linear between
/// the values on the left and right edges.
inline Point2 SampleBilinear(const Point2 &u, const Float w[4]) {
    const Float y = SampleLinear(u.y, w[0] + w[1], w[2] + w[3]);
    return {SampleLinear(u.x, Lerp(y, w[0], w[2]), Lerp(y, w[1], w[3])), y};
}
/// Interpolated value divided by its integral, the mean of the corner values.
inline Float BilinearPdf(const Point2 &p, const Float w[4]) {
    const bool inside = p.x >= 0 && p.x <= 1 && p.y >= 0 && p.y <= 1;
    if (!inside) return 0;
    const Float sum = w[0] + w[1] + w[2] + w[3];
    if (sum == 0) return 1;
    const Float lower = Lerp(p.x, w[0], w[1]), upper = Lerp(p.x, w[2], w[3]);
    return 4 * Lerp(p.y, lower, upper) / sum;
}

/// MIS weight of one sample from each of two densities (Veach).
inline Float PowerHeuristic(Float f, Float g) {
    if (std::isinf(f * f)) return 1;
    return f * f / (f * f + g * g);
}

/// Area-preserving map of the unit square to the sphere, z up (Clarberg 2008): pbrt's layout of environment images.
Vector3 EqualAreaSquareToSphere(const Point2 &p);
/// Inverse map; w must be a unit vector.
Point2 EqualAreaSphereToSquare(const Vector3 &w);
/// Wraps positions outside the square to the same direction inside (octahedral wrap-around).
Point2 WrapEqualAreaSquare(Point2 p);

}  // namespace pbrt
