#include "pbrt/math/warps.h"

namespace pbrt {

// The equal-area octahedral map (Clarberg, "Fast equal-area mapping of the (hemi)sphere using SIMD", 2008), derived for
// the square [-1, 1]^2 and one octant; the signs of the coordinates choose the octant.
//
// Latitude. The diamond |x| + |y| <= 1 is the upper hemisphere. The diamond |x| + |y| <= r has the area 2 r^2 out of 2,
// the cap above the height z the solid angle 2 Pi (1 - z) out of 2 Pi. Equal shares mean z = 1 - r^2, and hence
// sin(theta) = sqrt(1 - z^2) = r sqrt(2 - r^2).
// Azimuth. Along an edge of the diamond both area and solid angle grow evenly, so that the azimuth of an octant is
// linear in |y| - |x|, which goes from -r to r while the azimuth goes from 0 to Pi / 2.
// Lower hemisphere. The corners of the square mirror the diamond at its edges: in an octant (x, y) -> (1 - y, 1 - x).
// That keeps |y| - |x| and turns the distance from the edge, 1 - |x| - |y|, into its negative.

Vector3 EqualAreaSquareToSphere(const Point2 &p) {
    const Float x = 2 * p.x - 1, y = 2 * p.y - 1;
    const Float absX = std::abs(x), absY = std::abs(y);
    const Float fromEquator = 1 - (absX + absY);  // negative in the lower hemisphere
    const Float r = 1 - std::abs(fromEquator);
    const Float along = r != 0 ? (absY - absX) / r : 0;  // -1 to 1; the pole has every azimuth
    const Float azimuth = (along + 1) * Pi / 4;
    const Float cosTheta = 1 - r * r, sinTheta = r * SafeSqrt(2 - r * r);
    return {sinTheta * std::copysign(std::cos(azimuth), x), sinTheta * std::copysign(std::sin(azimuth), y),
            std::copysign(cosTheta, fromEquator)};
}

Point2 EqualAreaSphereToSquare(const Vector3 &w) {
    const Float r = SafeSqrt(1 - std::abs(w.z));
    // The edge of the diamond runs from (r, 0) to (0, r) while the azimuth goes from 0 to Pi / 2.
    const Float y = std::atan2(std::abs(w.y), std::abs(w.x)) * 2 * InvPi * r, x = r - y;
    const bool lower = w.z < 0;
    const Float absX = lower ? 1 - y : x, absY = lower ? 1 - x : y;
    return {(std::copysign(absX, w.x) + 1) / 2, (std::copysign(absY, w.y) + 1) / 2};
}

// Each half of an edge of the square shows the same directions as the other half, in reverse order. Crossing an edge is
// therefore half a turn about the middle of that edge.
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
