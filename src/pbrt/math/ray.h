#pragma once
#include "pbrt/core/ids.h"
#include "pbrt/math/vec.h"

namespace pbrt {

struct Ray {
    Point3 o{};
    Vector3 d{0, 0, 1};
    Float tMax = Infinity;
    Float time = 0;
    MediumId medium{};
    Point3 operator()(Float t) const { return o + d * t; }
};

/// Rays through the neighbouring film positions, one pixel to the right and one down (already scaled by sampling rate).
struct RayDifferential {
    bool valid = false;
    Point3 rxOrigin{}, ryOrigin{};
    Vector3 rxDirection{}, ryDirection{};

    void Scale(const Ray &ray, Float s) {
        rxOrigin = ray.o + (rxOrigin - ray.o) * s;
        ryOrigin = ray.o + (ryOrigin - ray.o) * s;
        rxDirection = ray.d + (rxDirection - ray.d) * s;
        ryDirection = ray.d + (ryDirection - ray.d) * s;
    }
};

/// Moves a point off its surface along the geometric normal n, to the side w points to, far enough that rounding
/// (|error| <= pError per component) cannot leave it on the other side.
inline Point3 OffsetRayOrigin(const Point3 &p, const Vector3 &pError, const Normal3 &n, const Vector3 &w) {
    Float d = Dot(Abs(n), pError);
    Vector3 offset = n * d;
    if (Dot(w, n) < 0) offset = -offset;
    Point3 po = p + offset;
    for (int i = 0; i < 3; ++i) {
        if (offset[i] > 0) po[i] = std::nextafter(po[i], Infinity);
        else if (offset[i] < 0) po[i] = std::nextafter(po[i], -Infinity);
    }
    return po;
}

/// Segment ends this fraction short of its target, so that the target itself does not block it.
inline constexpr Float ShadowEpsilon = 0.0001f;

}  // namespace pbrt
