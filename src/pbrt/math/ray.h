#pragma once
#include <bit>
#include <limits>

#include "pbrt/core/ids.h"
#include "pbrt/math/vec.h"

namespace pbrt {

struct Ray {
    Point3 o{};
    Vector3 d{0, 0, 1};     ///< of any length above 0
    Float tMax = Infinity;  ///< in units of d
    Float time = 0;         ///< in the unit of TransformTimes
    MediumId medium{};      ///< around o
    Point3 operator()(Float t) const { return o + d * t; }
};

/// Rays through the film positions one pixel to the right and one down, scaled by the sampling rate.
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

/// Next float above (`up`) or below a finite x; an inline std::nextafter.
inline Float NextFloat(Float x, bool up) {
    if (x == 0) return up ? std::numeric_limits<Float>::denorm_min() : -std::numeric_limits<Float>::denorm_min();
    const auto bits = std::bit_cast<uint32_t>(x);
    return std::bit_cast<Float>((x > 0) == up ? bits + 1 : bits - 1);
}

/// Offsets a ray origin along the geometric normal n to the side of w, so that rounding (|error| <= pError per
/// component) cannot leave it on the other side. The true point p + e has height e . n <= sum of pError_i |n_i| over
/// the plane through p. A step of that length along n clears the plane; one ulp away from the surface compensates the
/// rounding of p + step.
inline Point3 OffsetRayOrigin(const Point3 &p, const Vector3 &pError, const Normal3 &n, const Vector3 &w) {
    const Vector3 step = FaceForward(n, w) * Dot(Abs(n), pError);
    auto roundedAway = [](Float from, Float by) {
        const Float sum = from + by;
        return by == 0 || !(std::abs(sum) < Infinity) ? sum : NextFloat(sum, by > 0);
    };
    return {roundedAway(p.x, step.x), roundedAway(p.y, step.y), roundedAway(p.z, step.z)};
}

}  // namespace pbrt
