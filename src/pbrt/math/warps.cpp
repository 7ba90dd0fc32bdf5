#include "pbrt/math/warps.h"

namespace pbrt {

namespace {

/// The point or vector with the signs of another.
Point2 WithSigns(const Point2 &p, const Vector3 &signs) {
    return {std::copysign(p.x, signs.x), std::copysign(p.y, signs.y)};
}
Vector3 WithSigns(const Vector3 &v, const Vector3 &signs) {
    return {std::copysign(v.x, signs.x), std::copysign(v.y, signs.y), std::copysign(v.z, signs.z)};
}

}  // namespace

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
    const Point2 at = Float(2) * p - Float(1), octant = glm::abs(at);
    const Float fromEquator = 1 - (octant.x + octant.y);  // negative in the lower hemisphere
    const Float r = 1 - std::abs(fromEquator);
    const Float along = r != 0 ? (octant.y - octant.x) / r : 0;  // -1 to 1; the pole has every azimuth
    const Float azimuth = (along + 1) * Pi / 4;
    const Float cosTheta = 1 - r * r, sinTheta = r * SafeSqrt(2 - r * r);
    const Vector3 w(sinTheta * std::cos(azimuth), sinTheta * std::sin(azimuth), cosTheta);
    return WithSigns(w, Vector3(at, fromEquator));
}

Point2 EqualAreaSphereToSquare(const Vector3 &w) {
    const Vector3 octant = Abs(w);
    const Float r = SafeSqrt(1 - octant.z);
    // The edge of the diamond runs from (r, 0) to (0, r) while the azimuth goes from 0 to Pi / 2.
    const Float y = std::atan2(octant.y, octant.x) * 2 * InvPi * r, x = r - y;
    const Point2 at = w.z < 0 ? Point2(1 - y, 1 - x) : Point2(x, y);
    return (WithSigns(at, w) + Float(1)) / Float(2);
}

// Each half of an edge of the square shows the same directions as the other half, in reverse order. Crossing an edge is
// therefore half a turn about the middle of that edge.
Point2 WrapEqualAreaSquare(Point2 p) {
    for (int across : {0, 1}) {
        const int along = 1 - across;
        const Float edge = std::clamp(p[across], Float(0), Float(1));
        if (p[across] == edge) continue;
        p[across] = 2 * edge - p[across];
        p[along] = 1 - p[along];
    }
    return p;
}

}  // namespace pbrt
