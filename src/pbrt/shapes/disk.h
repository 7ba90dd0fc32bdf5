#pragma once
#include "pbrt/shapes/quadric.h"

namespace pbrt {

/// Disk at z = height about the z axis, facing +z, cut by an inner radius and phiMax.
class Disk final : public Quadric {
  public:
    /// phiMax in degrees.
    Disk(Float height, Float radius, Float innerRadius, Float phiMax, const Transform &renderFromObject,
         bool reverseOrientation);

    ShapeKind Kind() const override { return ShapeKind::Disk; }
    DirectionCone NormalBounds(uint32_t) const override { return {RenderNormal({0, 0, 1}), 1}; }

  protected:
    Bounds3 ObjectBounds() const override;
    Roots ObjectIntersect(const glm::dvec3 &o, const glm::dvec3 &d) const override;
    std::optional<Point2> Clip(const glm::dvec3 &p) const override;
    ObjectPoint PointAt(const Point2 &uv) const override;
    ObjectSample SampleObject(const Point2 &u) const override;
    Normal3 NormalAt(const Point3 &) const override { return {0, 0, 1}; }

  private:
    Float height_, radius_, innerRadius_, phiMax_;
};

}  // namespace pbrt
