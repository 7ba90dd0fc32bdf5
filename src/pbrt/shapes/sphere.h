#pragma once
#include "pbrt/shapes/quadric.h"

namespace pbrt {

/// Sphere about the object's origin, cut at zMin, zMax and phiMax.
///
/// A whole opaque sphere seen from outside is sampled uniformly over the cone of directions towards it. Other spheres
/// seen from outside are sampled by one of two methods, chosen with a fixed probability. The first draws a direction of
/// that cone and takes the first point of the part that the ray meets, if any. The second takes a point uniform by
/// area. The density of a point that the cone can find is the weighted sum of both, so that neither close nor small
/// parts are sampled badly. From inside, and if the transform does not keep it a sphere, a sphere is sampled by area
/// alone.
class Sphere final : public Quadric {
  public:
    /// Bounds as in the scene file: any order, clamped to the sphere; phiMax in degrees. `opaque` false: some rays pass
    /// through the surface (alpha), so that the farther one of two points in one direction is seen as well.
    Sphere(Float radius, Float zMin, Float zMax, Float phiMax, const Transform &renderFromObject,
           bool reverseOrientation, bool opaque = true);

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
    /// The cone of directions that meet the whole sphere; none from inside.
    struct Cone {
        Float distance;
        Float sinThetaMax;
        Float oneMinusCosThetaMax;
        Float Pdf() const { return 1 / (2 * Pi * oneMinusCosThetaMax); }  ///< solid angle
    };
    std::optional<Cone> ConeFrom(const ShapeSampleContext &from) const;
    /// The near side of a whole sphere, uniform in the cone.
    ShapeSample SampleNearSide(const Cone &cone, const ShapeSampleContext &from, const Point2 &u) const;
    /// The first point that a ray of the cone meets; pdf is not set.
    std::optional<ShapeSample> SampleFirstHit(const Cone &cone, const ShapeSampleContext &from, const Point2 &u) const;
    /// True if the ray from `from` to the point p of the surface meets no other point of it before.
    bool IsMetFirst(const ShapeSampleContext &from, const Vector3 &wi, const Point3 &p) const;

    Float radius_, zMin_, zMax_, thetaZMin_, thetaZMax_, phiMax_;
    bool opaque_;
    Float coneShare_;     ///< probability of sampling by the cone from outside; 1 for a whole opaque sphere
    Point3 center_;       ///< rendering space
    Float renderRadius_;  ///< rendering space, if a similarity
};

}  // namespace pbrt
