#include "pbrt/shapes/quadric.h"

#include "pbrt/shapes/weingarten.h"

namespace pbrt {

Cylinder::Cylinder(Float radius, Float zMin, Float zMax, Float phiMax, const Transform &renderFromObject,
                   bool reverseOrientation)
    : Quadric(renderFromObject, reverseOrientation), radius_(radius), zMin_(std::min(zMin, zMax)),
      zMax_(std::max(zMin, zMax)), phiMax_(Radians(std::clamp(phiMax, Float(0), Float(360)))) {
    SetArea((zMax_ - zMin_) * radius_ * phiMax_);
}

Bounds3 Cylinder::ObjectBounds() const { return {Point3(-radius_, -radius_, zMin_), Point3(radius_, radius_, zMax_)}; }

Quadric::Roots Cylinder::ObjectIntersect(const glm::dvec3 &o, const glm::dvec3 &d) const {
    // As for the sphere, in the xy plane.
    glm::dvec2 o2(o.x, o.y), d2(d.x, d.y);
    double a = glm::dot(d2, d2), r = double(radius_);
    if (!(a > 0)) return {};
    double m = -glm::dot(o2, d2) / a;
    glm::dvec2 nearest = o2 + m * d2;
    double rest = r * r - glm::dot(nearest, nearest);
    if (!(rest >= 0)) return {};
    double half = std::sqrt(rest / a), far = m >= 0 ? m + half : m - half;
    double near = far != 0 ? (glm::dot(o2, o2) - r * r) / (a * far) : 0;
    return {2, {std::min(near, far), std::max(near, far)}};
}

std::optional<Point2> Cylinder::Clip(const glm::dvec3 &p) const {
    double z0 = double(zMin_), z1 = double(zMax_);
    if (p.z < z0 || p.z > z1) return {};
    double phi = Azimuth(p.x, p.y);
    if (CutsAzimuth(phiMax_, phi)) return {};
    return Point2(std::min(static_cast<Float>(phi / double(phiMax_)), Float(1)),
                  static_cast<Float>((p.z - z0) / (z1 - z0)));
}

Quadric::ObjectPoint Cylinder::PointAt(const Point2 &uv) const {
    double phi = double(uv.x) * double(phiMax_);
    auto cosPhi = static_cast<Float>(std::cos(phi)), sinPhi = static_cast<Float>(std::sin(phi));
    Vector3 outward(cosPhi, sinPhi, 0), around(-sinPhi, cosPhi, 0);
    ObjectPoint at;
    at.p = {radius_ * cosPhi, radius_ * sinPhi, Lerp(uv.y, zMin_, zMax_)};
    at.pError = Gamma(3) * Abs(Vector3(at.p.x, at.p.y, 0));
    at.n = outward;
    at.dpdu = around * (phiMax_ * radius_);
    at.dpdv = {0, 0, zMax_ - zMin_};
    NormalDerivatives(at.dpdu, at.dpdv, outward * (-phiMax_ * phiMax_ * radius_), Vector3(0), Vector3(0), at.n,
                      &at.dndu, &at.dndv);
    return at;
}

Quadric::ObjectSample Cylinder::SampleObject(const Point2 &u) const {
    ObjectPoint at = PointAt({u.y, u.x});
    return {at.p, at.pError, at.n, {u.y, u.x}};
}

}  // namespace pbrt
