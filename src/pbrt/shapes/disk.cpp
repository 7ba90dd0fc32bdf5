#include "pbrt/shapes/quadric.h"

#include "pbrt/math/warps.h"

namespace pbrt {

Disk::Disk(Float height, Float radius, Float innerRadius, Float phiMax, const Transform &renderFromObject,
           bool reverseOrientation)
    : Quadric(renderFromObject, reverseOrientation), height_(height), radius_(radius),
      innerRadius_(std::max(innerRadius, Float(0))), phiMax_(Radians(std::clamp(phiMax, Float(0), Float(360)))) {
    SetArea(phiMax_ / 2 * (radius_ * radius_ - innerRadius_ * innerRadius_));
}

Bounds3 Disk::ObjectBounds() const { return {Point3(-radius_, -radius_, height_), Point3(radius_, radius_, height_)}; }

Quadric::Roots Disk::ObjectIntersect(const glm::dvec3 &o, const glm::dvec3 &d) const {
    if (d.z == 0) return {};
    return {1, {(double(height_) - o.z) / d.z, 0}};
}

std::optional<Point2> Disk::Clip(const glm::dvec3 &p) const {
    double r = std::sqrt(p.x * p.x + p.y * p.y), outer = double(radius_), inner = double(innerRadius_);
    if (!(r <= outer && r >= inner)) return {};
    double phi = Azimuth(p.x, p.y);
    if (CutsAzimuth(phiMax_, phi)) return {};
    return Point2(std::min(static_cast<Float>(phi / double(phiMax_)), Float(1)),
                  static_cast<Float>((outer - r) / (outer - inner)));
}

Quadric::ObjectPoint Disk::PointAt(const Point2 &uv) const {
    Float phi = uv.x * phiMax_, cosPhi = std::cos(phi), sinPhi = std::sin(phi);
    Float r = radius_ - uv.y * (radius_ - innerRadius_);
    ObjectPoint at;
    at.p = {r * cosPhi, r * sinPhi, height_};
    at.n = {0, 0, 1};
    at.dpdu = Vector3(-sinPhi, cosPhi, 0) * (phiMax_ * std::max(r, Float(1e-5) * radius_));
    at.dpdv = Vector3(cosPhi, sinPhi, 0) * (innerRadius_ - radius_);
    return at;
}

Quadric::ObjectSample Disk::SampleObject(const Point2 &u) const {
    ObjectSample at;
    at.n = {0, 0, 1};
    Float r, phi;
    if (innerRadius_ == 0 && IsFullTurn(phiMax_)) {
        Point2 d = SampleUniformDiskConcentric(u) * radius_;
        at.p = {d.x, d.y, height_};
        r = std::sqrt(d.x * d.x + d.y * d.y);
        phi = Azimuth(d.x, d.y);
    } else {
        r = std::sqrt(Lerp(u.x, innerRadius_ * innerRadius_, radius_ * radius_));
        phi = u.y * phiMax_;
        at.p = {r * std::cos(phi), r * std::sin(phi), height_};
    }
    at.uv = {phi / phiMax_, (radius_ - r) / (radius_ - innerRadius_)};
    return at;
}

}  // namespace pbrt
