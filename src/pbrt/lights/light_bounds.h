#pragma once
#include "pbrt/math/bounds.h"

namespace pbrt {

/// LightBounds with its box's bounding sphere: everything that the importance depends on.
struct LightSphere {
    Point3 center{};
    Float radius = 0;
    Vector3 w{0, 0, 1};
    Float phi = 0;
    Float cosTheta_o = 1, cosTheta_e = 0;
    bool twoSided = false;

    /// See LightBounds::Importance. Never NaN or infinite; positive wherever the emitter can contribute.
    Float Importance(const Point3 &p, const Normal3 &n) const;
};

/// Spatial and directional emission bounds (Conty and Kulla 2018; pbrt-v4): power phi leaves `bounds` within angle
/// theta_o of axis w, plus falloff theta_e beyond it.
struct LightBounds {
    Bounds3 bounds;
    Vector3 w{0, 0, 1};
    double phi = 0;
    Float cosTheta_o = 1, cosTheta_e = 0;
    bool twoSided = false;

    Point3 Centroid() const { return bounds.Center(); }
    LightSphere Sphere() const {
        // Positive powers stay positive, and sums of a few stay finite.
        const double inRange = phi > 0 ? std::clamp(phi, 1e-36, 1e36) : 0;
        return {Centroid(), Length(bounds.Diagonal()) / 2, w, Float(inRange), cosTheta_o, cosTheta_e, twoSided};
    }
    /// Upper-bound-like contribution estimate at p; n may be zero (medium). The receiver cosine is |cos| (transmissive
    /// surfaces may face away), as in stock pbrt-v4. Not inlined: bit-identical for equal arguments.
    Float Importance(const Point3 &p, const Normal3 &n) const;
};
/// Empty bounds (phi 0) are neutral.
LightBounds Union(const LightBounds &a, const LightBounds &b);

namespace detail {

/// Arithmetic of ImportanceOf for one light. SimdOps is the vector counterpart.
struct ScalarOps {
    using F = Float;
    static F Min(F a, F b) { return std::min(a, b); }
    static F Max(F a, F b) { return std::max(a, b); }
    static F Select(bool c, F ifTrue, F ifFalse) { return c ? ifTrue : ifFalse; }
    static F Sqrt(F a) { return std::sqrt(a); }
    static F Abs(F a) { return std::abs(a); }
};

/// Sine of an angle in [0, pi] from its cosine.
template <class Ops, class F = typename Ops::F>
F SineOf(const F &cosine) {
    return Ops::Sqrt(Ops::Max(F(1) - cosine * cosine, F(0)));
}

/// Values of a LightSphere, for one or several lights.
template <class F, class Mask>
struct Emitters {
    F centerX, centerY, centerZ, radius;
    F axisX, axisY, axisZ, axisLength2;  ///< any nonzero length
    F phi;
    F cosTheta_o, sinTheta_o, cosTheta_e;
    Mask twoSided;
};

template <class Ops, class F = typename Ops::F, class Mask>
[[gnu::always_inline]] inline F ImportanceOf(const Emitters<F, Mask> &e, const Point3 &p, const Normal3 &n) {
    constexpr Float kMax = 1e36f;  // the sum of two stays finite
    constexpr Float kTiny = std::numeric_limits<Float>::min();
    // sin^2 of a milliradian by which the sphere is enlarged. Otherwise rounding of directions could hide an emitter at
    // the border of its cone or of the receiver's horizon.
    constexpr Float kSlack = 1e-6f;
    // Falloff beyond 90 degrees (wide spot lights) still emits where the cosine is not positive.
    constexpr Float kMinCosine = 1e-3f;

    F vx = F(p.x) - e.centerX, vy = F(p.y) - e.centerY, vz = F(p.z) - e.centerZ;
    F d2 = vx * vx + vy * vy + vz * vz, r2 = e.radius * e.radius;
    auto inside = d2 <= r2 * F(Float(1.00001));
    d2 = Ops::Max(d2, F(kTiny));
    // Stock pbrt-v4 clamps the *squared* distance at *half the diagonal*. Units are inconsistent; kept so that
    // probabilities, and hence noise, match stock.
    F unoriented = Ops::Min(e.phi / Ops::Max(d2, e.radius), F(kMax));

    // Sines and cosines of single angles are scaled by the distance, those of differences by its square, and at the
    // axis by its length. This defers all divisions; roots and quotients dominate the cost, dependent ones most. The
    // difference of two angles is 0 where the second is larger.
    F distance = Ops::Sqrt(d2), invD2 = F(1) / d2, axisLength = Ops::Sqrt(e.axisLength2);
    F sinExtent2 = Ops::Min(r2 + F(kSlack) * d2, d2);
    F sinExtent = Ops::Sqrt(sinExtent2), cosExtent = Ops::Sqrt(d2 - sinExtent2);
    F cosAxis = e.axisX * vx + e.axisY * vy + e.axisZ * vz;
    cosAxis = Ops::Select(e.twoSided, Ops::Abs(cosAxis), cosAxis);
    F whole = distance * axisLength, whole2 = d2 * axisLength;
    cosAxis = Ops::Max(Ops::Min(cosAxis, whole), -whole);
    F sinAxis = Ops::Sqrt(Ops::Max(d2 * e.axisLength2 - cosAxis * cosAxis, F(0)));
    auto within = cosAxis > e.cosTheta_o * whole;
    F cosBeyond = Ops::Select(within, whole, cosAxis * e.cosTheta_o + sinAxis * e.sinTheta_o);
    F sinBeyond = Ops::Select(within, F(0), sinAxis * e.cosTheta_o - cosAxis * e.sinTheta_o);
    F leaving = Ops::Select(cosBeyond > cosExtent * axisLength, whole2, cosBeyond * cosExtent + sinBeyond * sinExtent);
    F oriented = Ops::Select(leaving > e.cosTheta_e * whole2,
                             Ops::Max(leaving, F(kMinCosine) * whole2) * (invD2 / axisLength), F(0));

    if (n.x != 0 || n.y != 0 || n.z != 0) {
        F cosReceiver = Ops::Min(Ops::Abs(F(n.x) * vx + F(n.y) * vy + F(n.z) * vz), distance);
        F sinReceiver = Ops::Sqrt(Ops::Max(d2 - cosReceiver * cosReceiver, F(0)));
        F arriving = Ops::Select(cosReceiver > cosExtent, d2, cosReceiver * cosExtent + sinReceiver * sinExtent);
        oriented = oriented * (arriving * invD2);
    }
    // Inside the sphere the emitter may lie in any direction. (Stock pbrt-v4 assumes this only inside the box, and a
    // half-space between box and sphere, which can give 0 to a visible light.)
    return unoriented * Ops::Select(inside, F(1), oriented);
}

}  // namespace detail

inline Float LightSphere::Importance(const Point3 &p, const Normal3 &n) const {
    using Ops = detail::ScalarOps;
    detail::Emitters<Float, bool> e{
        center.x,   center.y, center.z, radius, w.x, w.y, w.z, 1, phi, cosTheta_o, detail::SineOf<Ops>(cosTheta_o),
        cosTheta_e, twoSided};
    return detail::ImportanceOf<Ops>(e, p, n);
}

}  // namespace pbrt
