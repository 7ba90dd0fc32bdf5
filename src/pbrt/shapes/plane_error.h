#pragma once
#include "pbrt/math/vec.h"

namespace pbrt {

/// Direction of a x b in double precision; (0, 0, 1) if the product vanishes.
[[gnu::noinline]] inline Normal3 UnitCrossInDouble(const Vector3 &a, const Vector3 &b) {
    const glm::dvec3 exact = glm::cross(glm::dvec3(a), glm::dvec3(b));
    const double length = glm::length(exact);
    return length > 0 ? Normal3(exact / length) : Normal3(0, 0, 1);
}

/// Direction of a x b, in double precision only if squares of the float product are not normal numbers.
[[gnu::always_inline]] inline Normal3 RobustUnitCross(const Vector3 &a, const Vector3 &b) {
    const Vector3 n = Cross(a, b);
    const Float squared = LengthSquared(n);
    if (squared > Float(1e-32) && squared < Infinity) [[likely]]
        return n / std::sqrt(squared);
    return UnitCrossInDouble(a, b);
}

/// Error bound, along the normal, of the plane in Embree's test of triangle p0, p1, p2 for rays starting near its point
/// p. The test evaluates (p0 - o) . (a x b) with edges a = p2 - p0 and b = p0 - p1. Each component of the cross product
/// is a difference of products of (a, b) or (b, c), whichever are smaller. With the smaller product m and component N,
/// the products sum to 2 m + N. Roundings: two (edges) of 2 m + N, one of m, four (difference and sum) of N; less than
/// 6 (m + N). Axis-aligned planes have no error. The rounding of p0 - o counts as an error of o, whose bound is per
/// axis.
[[gnu::always_inline]] inline Float PlaneTestError(const Point3 &p0, const Point3 &p1, const Point3 &p2,
                                                   const Point3 &p) {
    // As RobustUnitCross(p1 - p0, p2 - p0), so that compilers share the product. Signs are irrelevant.
    const Vector3 b = p1 - p0, a = p2 - p0, c = p1 - p2, to = Abs(p0 - p), normal = Cross(b, a);
    const Vector3 ab = Abs(Vector3(a.z * b.y, a.x * b.z, a.y * b.x));
    const Vector3 bc = Abs(Vector3(b.z * c.y, b.x * c.z, b.y * c.x));
    const Float squared = LengthSquared(normal);
    // Slivers, and triangles whose squares are not normal numbers.
    if (!(squared > Float(1e-32) && squared < Infinity)) [[unlikely]]
        return Gamma(6) * MaxComponent(to);
    return Gamma(6) * Dot(to, Min(ab, bc) + Abs(normal)) / std::sqrt(squared);
}

/// Ratio of a primitive's span to the hit distance from which float parameters are too coarse for the hit's position.
constexpr Float kLargePrimitive = 256;
/// Parametric tolerance beyond a primitive's edges for rounding in Embree's tests and in the ray.
constexpr double kLargePrimitiveSlack = 0x1p-20;

}  // namespace pbrt
