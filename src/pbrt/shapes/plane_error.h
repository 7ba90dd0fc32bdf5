#pragma once
#include "pbrt/math/vec.h"

namespace pbrt {

/// The direction of a x b in double precision; (0, 0, 1) if the product vanishes.
[[gnu::noinline]] inline Normal3 UnitCrossInDouble(const Vector3 &a, const Vector3 &b) {
    const glm::dvec3 exact = glm::cross(glm::dvec3(a), glm::dvec3(b));
    const double length = glm::length(exact);
    return length > 0 ? Normal3(exact / length) : Normal3(0, 0, 1);
}

/// The direction of a x b, in double precision only where squares of the float product are not normal numbers.
[[gnu::always_inline]] inline Normal3 RobustUnitCross(const Vector3 &a, const Vector3 &b) {
    const Vector3 n = Cross(a, b);
    const Float squared = LengthSquared(n);
    if (squared > Float(1e-32) && squared < Infinity) [[likely]]
        return n / std::sqrt(squared);
    return UnitCrossInDouble(a, b);
}

/// Bound of the error, along the normal, of where Embree's test of the triangle p0, p1, p2 puts its plane for rays that
/// start near its point p. The test evaluates the volume (p0 - o) . (a x b) with the edges a = p2 - p0 and b = p0 - p1.
/// Each component of the cross product is a difference of products of the edges (a, b) or (b, c), whichever are
/// smaller: if m is the smaller and N the component, both products together are 2 m + N. Roundings: two (of the edges)
/// of 2 m + N, one of m, four (of the difference and the sum) of N; less than 6 (m + N). Planes along the axes have no
/// error. The rounding of p0 - o counts as an error of o, whose bound is per axis.
[[gnu::always_inline]] inline Float PlaneTestError(const Point3 &p0, const Point3 &p1, const Point3 &p2,
                                                   const Point3 &p) {
    // As RobustUnitCross(p1 - p0, p2 - p0), so that compilers share the product. Signs do not matter.
    const Vector3 b = p1 - p0, a = p2 - p0, c = p1 - p2, to = Abs(p0 - p), normal = Cross(b, a);
    const Vector3 ab = Abs(Vector3(a.z * b.y, a.x * b.z, a.y * b.x));
    const Vector3 bc = Abs(Vector3(b.z * c.y, b.x * c.z, b.y * c.x));
    const Float squared = LengthSquared(normal);
    // Slivers, and triangles whose squares are no normal numbers.
    if (!(squared > Float(1e-32) && squared < Infinity)) [[unlikely]]
        return Gamma(6) * MaxComponent(to);
    return Gamma(6) * Dot(to, Min(ab, bc) + Abs(normal)) / std::sqrt(squared);
}

/// The span of a primitive, relative to the distance of a hit on it, from which the hit's float parameters have too few
/// digits for its position.
constexpr Float kLargePrimitive = 256;
/// How far, in its parameters, Embree's tests and the rounding of the ray may put a hit beyond the edges of a
/// primitive.
constexpr double kLargePrimitiveSlack = 0x1p-20;

}  // namespace pbrt
