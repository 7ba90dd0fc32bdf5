#include "pbrt/math/warps.h"

namespace pbrt {

// The square is folded like an octahedron: distance from the diagonals gives the latitude so that equal areas map to
// equal solid angles, position along the fold gives the azimuth inside a quadrant.
Vector3 EqualAreaSquareToSphere(const Point2 &p) {
    Float u = 2 * p.x - 1, v = 2 * p.y - 1;
    Float au = std::abs(u), av = std::abs(v);
    Float signedDistance = 1 - (au + av);
    Float d = std::abs(signedDistance);
    Float r = 1 - d;
    Float phi = (r == 0 ? 1 : (av - au) / r + 1) * Pi / 4;
    Float z = std::copysign(1 - r * r, signedDistance);
    Float radius = r * SafeSqrt(2 - r * r);
    return {std::copysign(std::cos(phi), u) * radius, std::copysign(std::sin(phi), v) * radius, z};
}

Point2 EqualAreaSphereToSquare(const Vector3 &w) {
    Float x = std::abs(w.x), y = std::abs(w.y), z = std::abs(w.z);
    Float r = SafeSqrt(1 - z);
    Float phi = x == 0 && y == 0 ? 0 : std::atan2(y, x) * 2 * InvPi;  // 0..1 over the quadrant
    Float v = phi * r;
    Float u = r - v;
    if (w.z < 0) {
        std::swap(u, v);
        u = 1 - u;
        v = 1 - v;
    }
    u = std::copysign(u, w.x);
    v = std::copysign(v, w.y);
    return {(u + 1) / 2, (v + 1) / 2};
}

Point2 WrapEqualAreaSquare(Point2 p) {
    if (p.x < 0) p = {-p.x, 1 - p.y};
    else if (p.x > 1) p = {2 - p.x, 1 - p.y};
    if (p.y < 0) p = {1 - p.x, -p.y};
    else if (p.y > 1) p = {1 - p.x, 2 - p.y};
    return p;
}

}  // namespace pbrt
