#pragma once
#include "pbrt/shapes/quadric.h"

namespace pbrt {

/// Sphere about the object's origin, cut at zMin, zMax and phiMax. Seen from outside, the directions towards the whole
/// sphere are sampled uniformly (if the transform keeps it a sphere); from inside and else, by area.
class Sphere final : public Quadric {
  public:
    /// Bounds as in the scene file: any order, clamped to the sphere; phiMax in degrees.
    Sphere(Float radius, Float zMin, Float zMax, Float phiMax, const Transform &renderFromObject,
           bool reverseOrientation);

    ShapeKind Kind() const override { return ShapeKind::Sphere; }
    DirectionCone NormalBounds(uint32_t) const override { return DirectionCone::EntireSphere(); }
    std::optional<ShapeSample> Sample(uint32_t primitive, const ShapeSampleContext &from,
                                      const Point2 &u) const override;
    Float PdfSolidAngle(uint32_t primitive, const ShapeSampleContext &from, const Vector3 &wi, const Point3 &pHit,
                        const Normal3 &nHit) const override;

  protected:
    Bounds3 ObjectBounds() const override;
    Roots ObjectIntersect(const glm::dvec3 &o, const glm::dvec3 &d) const override;
    std::optional<Point2> Clip(const glm::dvec3 &p) const override;
    ObjectPoint PointAt(const Point2 &uv) const override;
    ObjectSample SampleObject(const Point2 &u) const override;
    Normal3 NormalAt(const Point3 &p) const override { return p; }

  private:
    Point2 UvOf(const glm::dvec3 &p) const;
    /// The cone of directions that meet the sphere; none from inside.
    struct Cone {
        Float distance;
        Float sinThetaMax;
        Float oneMinusCosThetaMax;
    };
    std::optional<Cone> ConeFrom(const ShapeSampleContext &from) const;

    Float radius_, zMin_, zMax_, thetaZMin_, thetaZMax_, phiMax_;
    Point3 center_;       ///< rendering space
    Float renderRadius_;  ///< rendering space, if a similarity
};

}  // namespace pbrt
