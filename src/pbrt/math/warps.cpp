#include "pbrt/math/warps.h"

namespace pbrt {

// Equal-area octahedral map (Clarberg, "Fast equal-area mapping of the (hemi)sphere using SIMD", 2008), derived for one
// octant of the square [-1, 1]^2; the signs of the coordinates select the octant.
//
// Latitude: the diamond |x| + |y| <= 1 is the upper hemisphere. The diamond |x| + |y| <= r has area 2 r^2 of 2, the cap
// above height z solid angle 2 Pi (1 - z) of 2 Pi. Equating gives z = 1 - r^2 and sin(theta) = sqrt(1 - z^2) = r sqrt(2
// - r^2).
//
// Azimuth: area and solid angle grow evenly along an edge of the diamond. The azimuth in the octant is thus linear in
// |y| - |x|, from 0 at -r to Pi / 2 at r.
//
// Lower hemisphere: the corners of the square mirror the diamond at its edges, (x, y) -> (1 - y, 1 - x) in the octant.
// This keeps |y| - |x| and negates the distance from the edge, 1 - |x| - |y|.

Vector3 EqualAreaSquareToSphere(const Point2 &p) {
    const Float x = 2 * p.x - 1, y = 2 * p.y - 1;
    const Float absX = std::abs(x), absY = std::abs(y);
    const Float fromEquator = 1 - (absX + absY);  // negative in the lower hemisphere
    const Float r = 1 - std::abs(fromEquator);
    const Float along = r != 0 ? (absY - absX) / r : 0;  // -1 to 1; arbitrary at the pole
    const Float azimuth = (along + 1) * Pi / 4;
    const Float cosTheta = 1 - r * r, sinTheta = r * SafeSqrt(2 - r * r);
    return {sinTheta * std::copysign(std::cos(azimuth), x), sinTheta * std::copysign(std::sin(azimuth), y),
            std::copysign(cosTheta, fromEquator)};
}

Point2 EqualAreaSphereToSquare(const Vector3 &w) {
    const Float r = SafeSqrt(1 - std::abs(w.z));
    // The diamond's edge from (r, 0) to (0, r) spans azimuths from 0 to Pi / 2.
    const Float y = std::atan2(std::abs(w.y), std::abs(w.x)) * 2 * InvPi * r, x = r - y;
    const bool lower = w.z < 0;
    const Float absX = lower ? 1 - y : x, absY = lower ? 1 - x : y;
    return {(std::copysign(absX, w.x) + 1) / 2, (std::copysign(absY, w.y) + 1) / 2};
}

// The halves of each edge show the same directions in reverse: crossing it is a half turn about its midpoint.
Point2 WrapEqualAreaSquare(Point2 p) {
    auto cross = [](Float &across, Float &along) {
        const Float edge = across < 0 ? Float(0) : Float(1);
        if (across >= 0 && across <= 1) return;
        across = 2 * edge - across;
        along = 1 - along;
    };
    cross(p.x, p.y);
    cross(p.y, p.x);
    return p;
}

}  // namespace pbrt
