#include "pbrt/shapes/shape.h"

namespace pbrt {
namespace {

/// Error bound, in the outer space, of transforming p to the inner space by a float inverse. Sums of magnitudes are
/// pessimistic: one rounding each suffices in random walks inside instances, three are safe. More would push points
/// past their neighbours in strongly flattened instances.
Vector3 ReturnError(const Transform &t, const Point3 &p) {
    glm::mat3 forward, back;
    for (int c = 0; c < 3; ++c) {
        forward[c] = Abs(Vector3(t.Matrix()[c]));
        back[c] = Abs(Vector3(t.InverseMatrix()[c]));
    }
    return forward * (back * (Abs(p) + Abs(Vector3(t.Matrix()[3])))) * Gamma(3);
}

Normal3 UnitNormal(const Transform &t, const Normal3 &n) {
    Normal3 moved = t.Normal(n);
    Float length = Length(moved);
    return length > 0 ? moved / length : n;
}

}  // namespace

SurfacePoint TransformSurface(const Transform &t, const SurfacePoint &s) {
    SurfacePoint r = s;
    r.p = t.Point(s.p);
    r.pError = t.PointError(s.p, s.pError) + ReturnError(t, r.p);
    r.n = UnitNormal(t, s.n);
    r.dpdu = t.Vector(s.dpdu);
    r.dpdv = t.Vector(s.dpdv);
    const Normal3 placed = t.Normal(s.n), placedShading = t.Normal(s.shading.n);
    r.dndu = UnitNormalDerivative(placed, t.Normal(s.dndu));
    r.dndv = UnitNormalDerivative(placed, t.Normal(s.dndv));
    r.shading.n = FaceForward(UnitNormal(t, s.shading.n), r.n);
    r.shading.dpdu = t.Vector(s.shading.dpdu);
    r.shading.dpdv = t.Vector(s.shading.dpdv);
    r.shading.dndu = UnitNormalDerivative(placedShading, t.Normal(s.shading.dndu));
    r.shading.dndv = UnitNormalDerivative(placedShading, t.Normal(s.shading.dndv));
    return r;
}

Bounds3 PlacedBounds(const Transform &t, const Bounds3 &b) {
    Bounds3 placed;
    for (int i = 0; i < 8; ++i) {
        const Point3 corner = b.Corner(i), p = t.Point(corner);
        const Vector3 error = t.PointError(corner);
        placed = Union(placed, Bounds3(p - error, p + error));
    }
    return placed;
}

bool Shape::IsRounding(double height, const glm::dvec3 &n, const Vector3 &rounded, Float reach, const Vector3 &pError) {
    const glm::dvec3 error(Gamma(1) * rounded + Min(pError, Vector3(Gamma(32) * reach)));
    return std::abs(height) <= glm::dot(glm::abs(n), error);
}

}  // namespace pbrt
