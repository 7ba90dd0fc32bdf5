#pragma once
#include "pbrt/shapes/quadric.h"

namespace pbrt {

/// Open cylinder about the z axis between zMin and zMax, cut at phiMax.
class Cylinder final : public Quadric {
  public:
    /// zMin and zMax in any order; phiMax in degrees.
    Cylinder(Float radius, Float zMin, Float zMax, Float phiMax, const Transform &renderFromObject,
             bool reverseOrientation);

    ShapeKind Kind() const override { return ShapeKind::Cylinder; }
    DirectionCone NormalBounds(uint32_t) const override { return DirectionCone::EntireSphere(); }

  protected:
    Bounds3 ObjectBounds() const override;
    Roots ObjectIntersect(const glm::dvec3 &o, const glm::dvec3 &d) const override;
    std::optional<Point2> Clip(const glm::dvec3 &p) const override;
    ObjectPoint PointAt(const Point2 &uv) const override;
    ObjectSample SampleObject(const Point2 &u) const override;
    Normal3 NormalAt(const Point3 &p) const override { return {p.x, p.y, 0}; }

  private:
    Float radius_, zMin_, zMax_, phiMax_;
};

}  // namespace pbrt
