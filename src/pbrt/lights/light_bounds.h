#pragma once
#include "pbrt/math/bounds.h"

namespace pbrt {

/// LightBounds with the box replaced by its bounding sphere: all that the importance depends on.
struct LightSphere {
    Point3 center{};
    Float radius = 0;
    Vector3 w{0, 0, 1};
    Float phi = 0;
    Float cosTheta_o = 1, cosTheta_e = 0;
    bool twoSided = false;

    /// See LightBounds::Importance. Never NaN, never infinite; positive wherever the emitter can contribute.
    Float Importance(const Point3 &p, const Normal3 &n) const;
};

/// Where a light is, how strong, and where it shines (Conty and Kulla 2018; pbrt-v4): power phi leaves `bounds` within
/// angle theta_o of axis w, plus falloff theta_e beyond it.
struct LightBounds {
    Bounds3 bounds;
    Vector3 w{0, 0, 1};
    Float phi = 0;
    Float cosTheta_o = 1, cosTheta_e = 0;
    bool twoSided = false;

    Point3 Centroid() const { return bounds.Center(); }
    LightSphere Sphere() const {
        return {Centroid(), Length(bounds.Diagonal()) / 2, w, phi, cosTheta_o, cosTheta_e, twoSided};
    }
    /// Upper-bound-like estimate of the contribution at p; n may be zero (medium). Receiver cosine as |cos| (a
    /// transmissive surface may face away), as stock pbrt-v4. Not inlined: equal arguments give equal bits everywhere.
    Float Importance(const Point3 &p, const Normal3 &n) const;
};
/// Empty bounds (phi 0) are neutral.
LightBounds Union(const LightBounds &a, const LightBounds &b);

namespace detail {
struct CosSin {
    Float cos, sin;
};
/// The angle a - b, or 0 if b is larger. Both in [0, pi].
inline CosSin SubtractAngles(CosSin a, CosSin b) {
    if (a.cos > b.cos) return {1, 0};
    return {a.cos * b.cos + a.sin * b.sin, a.sin * b.cos - a.cos * b.sin};
}
inline CosSin FromCosine(Float c) { return {c, SafeSqrt(1 - c * c)}; }
}  // namespace detail

inline Float LightSphere::Importance(const Point3 &p, const Normal3 &n) const {
    constexpr Float kMost = 1e36f;  // two of them still add up to a finite number
    // sin^2 of a thousandth of a radian: the sphere looks that much larger, so that rounding of directions cannot hide
    // an emitter that grazes the border of its cone or of the receiver's horizon.
    constexpr Float kSlack = 1e-6f;
    // A falloff region beyond 90 degrees (wide spot lights) still emits where the cosine is not positive.
    constexpr Float kLeastCosine = 1e-3f;

    Vector3 v = p - center;
    Float d2 = LengthSquared(v);
    // Stock pbrt-v4 clamps the *squared* distance at *half the diagonal*. The units do not agree; the rule is kept
    // because the probabilities, and so the noise, are to be stock's.
    Float importance = phi / std::max(d2, radius);
    Float r2 = radius * radius;
    // Inside the sphere the emitter may lie in any direction. (Stock pbrt-v4 says so only inside the box and assumes a
    // half-space between box and sphere, which can give 0 to a light that is seen.)
    if (d2 <= r2 * Float(1.00001)) return phi > 0 ? std::min(importance, kMost) : 0;

    Float invDistance = 1 / std::sqrt(d2);
    Float sin2 = std::min(Float(1), r2 * invDistance * invDistance + kSlack);
    detail::CosSin extent{std::sqrt(1 - sin2), std::sqrt(sin2)};

    Float cosAxis = std::clamp(Dot(w, v) * invDistance, Float(-1), Float(1));
    if (twoSided) cosAxis = std::abs(cosAxis);
    detail::CosSin beyond = SubtractAngles(detail::FromCosine(cosAxis), detail::FromCosine(cosTheta_o));
    beyond = SubtractAngles(beyond, extent);
    if (beyond.cos <= cosTheta_e) return 0;
    importance *= std::max(beyond.cos, kLeastCosine);

    if (n.x != 0 || n.y != 0 || n.z != 0) {
        Float cosReceiver = std::min(std::abs(Dot(v, n)) * invDistance, Float(1));
        importance *= SubtractAngles(detail::FromCosine(cosReceiver), extent).cos;
    }
    return std::clamp(importance, Float(0), kMost);
}

}  // namespace pbrt
