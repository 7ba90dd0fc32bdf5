#pragma once
#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <limits>
#include <numbers>

#include "pbrt/core/float.h"

namespace pbrt {

// GLM types. Points, vectors and normals share a type and differ by name.
using Point2 = glm::vec2;
using Vector2 = glm::vec2;
using Point3 = glm::vec3;
using Vector3 = glm::vec3;
using Normal3 = glm::vec3;
using Point2i = glm::ivec2;
using Vector2i = glm::ivec2;

inline constexpr Float Pi = std::numbers::pi_v<Float>;
inline constexpr Float InvPi = std::numbers::inv_pi_v<Float>;
inline constexpr Float Inv2Pi = InvPi / 2;
inline constexpr Float Inv4Pi = InvPi / 4;
inline constexpr Float Infinity = std::numeric_limits<Float>::infinity();
/// Largest float below 1; random numbers are in [0, OneMinusEpsilon].
inline constexpr Float OneMinusEpsilon = 0x1.fffffep-1f;
inline constexpr Float MachineEpsilon = std::numeric_limits<Float>::epsilon() / 2;

/// Relative rounding error bound of n chained operations.
constexpr Float Gamma(int n) {
    Float e = Float(n) * MachineEpsilon;
    return e / (1 - e);
}

constexpr Float Radians(Float degrees) { return degrees * (Pi / 180); }

template <class T>
constexpr T Sqr(T v) {
    return v * v;
}
inline Float SafeSqrt(Float v) { return std::sqrt(std::max(Float(0), v)); }
inline Float SafeASin(Float v) { return std::asin(std::clamp(v, Float(-1), Float(1))); }
inline Float SafeACos(Float v) { return std::acos(std::clamp(v, Float(-1), Float(1))); }
template <class T>
constexpr T Lerp(Float t, const T &a, const T &b) {
    return a * (1 - t) + b * t;
}

/// Of a GLM vector, without the branches of its operator[], for an axis that is not a constant.
template <class V>
auto &Component(V &v, int axis) {
    return glm::value_ptr(v)[axis];
}

/// a*b - c*d without catastrophic cancellation (Kahan).
inline Float DifferenceOfProducts(Float a, Float b, Float c, Float d) {
    Float cd = c * d;
    return std::fma(a, b, -cd) + std::fma(-c, d, cd);
}

inline Float Dot(const Vector3 &a, const Vector3 &b) { return glm::dot(a, b); }
inline Float AbsDot(const Vector3 &a, const Vector3 &b) { return std::abs(glm::dot(a, b)); }
inline Vector3 Cross(const Vector3 &a, const Vector3 &b) {
    return {DifferenceOfProducts(a.y, b.z, a.z, b.y), DifferenceOfProducts(a.z, b.x, a.x, b.z),
            DifferenceOfProducts(a.x, b.y, a.y, b.x)};
}
inline Float LengthSquared(const Vector3 &v) { return glm::dot(v, v); }
inline Float Length(const Vector3 &v) { return std::sqrt(LengthSquared(v)); }
inline Vector3 Normalize(const Vector3 &v) { return v / Length(v); }
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
/// Length of a x b, also if its square is not a normal number.
inline Float CrossLength(const Vector3 &a, const Vector3 &b) {
    const Vector3 n = Cross(a, b);
    const Float squared = LengthSquared(n);
    if (squared > Float(1e-32) && squared < Infinity) [[likely]]
        return std::sqrt(squared);
    return Float(glm::length(glm::cross(glm::dvec3(a), glm::dvec3(b))));
}
inline Float DistanceSquared(const Point3 &a, const Point3 &b) { return LengthSquared(a - b); }
inline Float Distance(const Point3 &a, const Point3 &b) { return Length(a - b); }
inline Vector3 FaceForward(const Vector3 &n, const Vector3 &v) { return Dot(n, v) < 0 ? -n : n; }
inline Vector3 Abs(const Vector3 &v) { return glm::abs(v); }
inline Float MaxComponent(const Vector3 &v) { return std::max({v.x, v.y, v.z}); }
inline Point3 Min(const Point3 &a, const Point3 &b) { return glm::min(a, b); }
inline Point3 Max(const Point3 &a, const Point3 &b) { return glm::max(a, b); }

/// Angle in radians between unit vectors, accurate near 0 and Pi: they span an isosceles triangle with base 2 sin(t /
/// 2). Beyond a right angle, uses a and -b at the angle Pi - t, where the arcsine amplifies rounding less.
inline Float AngleBetween(const Vector3 &a, const Vector3 &b) {
    const bool obtuse = Dot(a, b) < 0;
    const Float base = Length(obtuse ? a + b : a - b);
    const Float apex = 2 * SafeASin(base / 2);
    return obtuse ? Pi - apex : apex;
}

/// Completes the unit vector v to a right-handed orthonormal basis (Duff et al. 2017).
inline void CoordinateSystem(const Vector3 &v, Vector3 *s, Vector3 *t) {
    Float sign = std::copysign(Float(1), v.z);
    Float a = -1 / (sign + v.z);
    Float b = v.x * v.y * a;
    *s = {1 + sign * Sqr(v.x) * a, sign * b, -sign * v.x};
    *t = {b, sign + Sqr(v.y) * a, -v.y};
}

/// Unit vector at polar angle theta from +z and azimuth phi from +x.
inline Vector3 SphericalDirection(Float sinTheta, Float cosTheta, Float phi) {
    return {sinTheta * std::cos(phi), sinTheta * std::sin(phi), cosTheta};
}

}  // namespace pbrt
