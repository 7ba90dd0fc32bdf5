#pragma once
#include "pbrt/math/bounds.h"

namespace pbrt {

/// Where a light is, how strong, and where it shines (Conty and Kulla 2018; pbrt-v4): power phi leaves `bounds` within
/// angle theta_o of axis w, plus falloff theta_e beyond it.
struct LightBounds {
    Bounds3 bounds;
    Vector3 w{0, 0, 1};
    Float phi = 0;
    Float cosTheta_o = 1, cosTheta_e = 0;
    bool twoSided = false;

    Point3 Centroid() const { return bounds.Center(); }
    /// Upper-bound-like estimate of the contribution at p; n may be zero (medium). Receiver cosine as |cos| (a
    /// transmissive surface may face away), as stock pbrt-v4.
    Float Importance(const Point3 &p, const Normal3 &n) const;
};
LightBounds Union(const LightBounds &a, const LightBounds &b);

}  // namespace pbrt
