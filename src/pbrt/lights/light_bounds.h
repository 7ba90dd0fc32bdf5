#pragma once
#include "pbrt/math/bounds.h"
#include "pbrt/math/transform.h"

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
/// True if lengths and angles keep their proportions: cones stay cones.
bool IsSimilarity(const Transform &t);
/// Empty bounds (phi 0) are neutral.
LightBounds Union(const LightBounds &a, const LightBounds &b);

namespace detail {

/// The arithmetic of ImportanceOf for one light at a time. SimdOps has the same members for several lights.
struct ScalarOps {
    using F = Float;
    static F Min(F a, F b) { return std::min(a, b); }
    static F Max(F a, F b) { return std::max(a, b); }
    static F Select(bool c, F ifTrue, F ifFalse) { return c ? ifTrue : ifFalse; }
    static F Sqrt(F a) { return std::sqrt(a); }
    static F Abs(F a) { return std::abs(a); }
};

template <class F>
struct CosSin {
    F cos, sin;
};
/// The angle a - b, or 0 if b is larger. Both in [0, pi].
template <class Ops, class F = typename Ops::F>
CosSin<F> SubtractAngles(const CosSin<F> &a, const CosSin<F> &b) {
    auto larger = a.cos > b.cos;
    return {Ops::Select(larger, F(1), a.cos * b.cos + a.sin * b.sin),
            Ops::Select(larger, F(0), a.sin * b.cos - a.cos * b.sin)};
}
template <class Ops, class F = typename Ops::F>
CosSin<F> FromCosine(const F &c) {
    return {c, Ops::Sqrt(Ops::Max(F(1) - c * c, F(0)))};
}

/// The values of a LightSphere, for one light or for several at a time.
template <class F, class Mask>
struct Emitters {
    F centerX, centerY, centerZ, radius;
    F axisX, axisY, axisZ, phi;
    CosSin<F> theta_o;
    F cosTheta_e;
    Mask twoSided;
};

template <class Ops, class F = typename Ops::F, class Mask>
F ImportanceOf(const Emitters<F, Mask> &e, const Point3 &p, const Normal3 &n) {
    constexpr Float kMax = 1e36f;  // two of them still add up to a finite number
    constexpr Float kTiny = std::numeric_limits<Float>::min();
    // sin^2 of a thousandth of a radian: the sphere is taken to be that much larger, so that rounding of directions
    // cannot hide an emitter that grazes the border of its cone or of the receiver's horizon.
    constexpr Float kSlack = 1e-6f;
    // A falloff region beyond 90 degrees (wide spot lights) still emits where the cosine is not positive.
    constexpr Float kMinCosine = 1e-3f;

    F vx = F(p.x) - e.centerX, vy = F(p.y) - e.centerY, vz = F(p.z) - e.centerZ;
    F d2 = vx * vx + vy * vy + vz * vz, r2 = e.radius * e.radius;
    // Stock pbrt-v4 clamps the *squared* distance at *half the diagonal*. The units do not agree; the rule is kept
    // because the probabilities, and so the noise, are to be stock's.
    F unoriented = Ops::Min(e.phi / Ops::Max(Ops::Max(d2, e.radius), F(kTiny)), F(kMax));
    F invDistance = F(1) / Ops::Sqrt(Ops::Max(d2, F(kTiny)));
    F sin2 = Ops::Min(r2 * invDistance * invDistance + F(kSlack), F(1));
    CosSin<F> extent{Ops::Sqrt(F(1) - sin2), Ops::Sqrt(sin2)};

    F cosAxis = (e.axisX * vx + e.axisY * vy + e.axisZ * vz) * invDistance;
    cosAxis = Ops::Max(Ops::Min(cosAxis, F(1)), F(-1));
    cosAxis = Ops::Select(e.twoSided, Ops::Abs(cosAxis), cosAxis);
    CosSin<F> beyond = SubtractAngles<Ops>(SubtractAngles<Ops>(FromCosine<Ops>(cosAxis), e.theta_o), extent);
    F oriented = Ops::Select(beyond.cos > e.cosTheta_e, Ops::Max(beyond.cos, F(kMinCosine)), F(0));

    if (n.x != 0 || n.y != 0 || n.z != 0) {
        F cosReceiver = Ops::Min(Ops::Abs(F(n.x) * vx + F(n.y) * vy + F(n.z) * vz) * invDistance, F(1));
        oriented = oriented * Ops::Max(SubtractAngles<Ops>(FromCosine<Ops>(cosReceiver), extent).cos, F(0));
    }
    // Inside the sphere the emitter may lie in any direction. (Stock pbrt-v4 allows for this only inside the box and
    // assumes a half-space between box and sphere, which can give 0 to a light that is seen.)
    return unoriented * Ops::Select(d2 <= r2 * F(Float(1.00001)), F(1), oriented);
}

}  // namespace detail

inline Float LightSphere::Importance(const Point3 &p, const Normal3 &n) const {
    using Ops = detail::ScalarOps;
    detail::Emitters<Float, bool> e{
        center.x,   center.y, center.z, radius, w.x, w.y, w.z, phi, detail::FromCosine<Ops>(cosTheta_o),
        cosTheta_e, twoSided};
    return detail::ImportanceOf<Ops>(e, p, n);
}

}  // namespace pbrt
