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
/// (|error| <= pError per component) cannot leave it on the other side. Derivation: the true point is p + e, and its
/// height over the plane through p is e . n, at most the sum of pError_i |n_i|. A step of that length along n clears
/// the plane; the sum p + step is rounded once more, which one unit in the last place away from the surface makes up
/// for.
inline Point3 OffsetRayOrigin(const Point3 &p, const Vector3 &pError, const Normal3 &n, const Vector3 &w) {
    const Vector3 step = FaceForward(n, w) * Dot(Abs(n), pError);
    auto roundedAway = [](Float from, Float by) {
        const Float sum = from + by;
        return by == 0 ? sum : std::nextafter(sum, std::copysign(Infinity, by));
    };
    return {roundedAway(p.x, step.x), roundedAway(p.y, step.y), roundedAway(p.z, step.z)};
}

}  // namespace pbrt
