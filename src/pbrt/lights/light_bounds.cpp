#include "pbrt/lights/light_bounds.h"

namespace pbrt {

Float LightBounds::Importance(const Point3 &p, const Normal3 &n) const { return Sphere().Importance(p, n); }

bool IsSimilarity(const Transform &t) {
    Vector3 x = t.Vector({1, 0, 0}), y = t.Vector({0, 1, 0}), z = t.Vector({0, 0, 1});
    Float xx = LengthSquared(x), tolerance = 1e-4f * xx;
    return std::abs(LengthSquared(y) - xx) <= tolerance && std::abs(LengthSquared(z) - xx) <= tolerance &&
           AbsDot(x, y) <= tolerance && AbsDot(y, z) <= tolerance && AbsDot(z, x) <= tolerance;
}

LightBounds Union(const LightBounds &a, const LightBounds &b) {
    if (!(a.phi > 0)) return b;
    if (!(b.phi > 0)) return a;
    DirectionCone cone = Union(DirectionCone{a.w, a.cosTheta_o}, DirectionCone{b.w, b.cosTheta_o});
    LightBounds u;
    u.bounds = Union(a.bounds, b.bounds);
    u.w = cone.w;
    u.phi = a.phi + b.phi;
    u.cosTheta_o = cone.cosTheta;
    u.cosTheta_e = std::min(a.cosTheta_e, b.cosTheta_e);
    u.twoSided = a.twoSided || b.twoSided;
    return u;
}

}  // namespace pbrt
