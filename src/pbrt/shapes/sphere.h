#pragma once
#include "pbrt/shapes/quadric.h"

namespace pbrt {

/// Sphere about the object's origin, cut at zMin, zMax and phiMax.
///
/// A whole sphere seen from outside is sampled uniformly over the cone of directions towards it. For a part of one that
/// cone is one of two methods, chosen with a fixed probability: a direction of the cone whose ray meets the part yields
/// the point it meets first, others yield nothing. The other method takes a point uniform by area. Both densities count
/// for a point that the cone could have found, so that neither points close by nor small parts are sampled badly. From
/// inside, and if the transform does not keep it a sphere, by area alone.
class Sphere final : public Quadric {
  public:
    /// Bounds as in the scene file: any order, clamped to the sphere; phiMax in degrees. `opaque` false: some rays pass
    /// through the surface (alpha), so that of two points in one direction the farther one is seen too.
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
    /// What a ray of the cone meets first. Without its density.
    std::optional<ShapeSample> SampleFirstHit(const Cone &cone, const ShapeSampleContext &from, const Point2 &u) const;
    /// True if the ray from `from` to the point p of the surface meets no other point of it before.
    bool IsMetFirst(const ShapeSampleContext &from, const Vector3 &wi, const Point3 &p) const;

    Float radius_, zMin_, zMax_, thetaZMin_, thetaZMax_, phiMax_;
    bool opaque_;
    Float coneShare_;     ///< probability of the cone, seen from outside; 1 for a whole sphere
    Point3 center_;       ///< rendering space
    Float renderRadius_;  ///< rendering space, if a similarity
};

}  // namespace pbrt
