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
    const bool neutralA = !(a.phi > 0), neutralB = !(b.phi > 0);
    if (neutralA || neutralB) return neutralA ? b : a;
    auto normals = [](const LightBounds &light) { return DirectionCone{light.w, light.cosTheta_o}; };
    const DirectionCone joint = Union(normals(a), normals(b));
    return {.bounds = Union(a.bounds, b.bounds),
            .w = joint.w,
            .phi = a.phi + b.phi,
            .cosTheta_o = joint.cosTheta,
            .cosTheta_e = std::min(a.cosTheta_e, b.cosTheta_e),  // wider falloff
            .twoSided = a.twoSided || b.twoSided};
}

}  // namespace pbrt
