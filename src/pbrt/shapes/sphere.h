#pragma once
#include "pbrt/shapes/quadric.h"

namespace pbrt {

/// Sphere about the object-space origin, cut at zMin, zMax and phiMax.
///
/// From outside, a full opaque sphere is sampled uniformly in the cone of directions towards it. Partial or non-opaque
/// spheres combine two techniques with fixed probability: the first hit along a cone direction, if any, and a point
/// uniform by area. Densities of points the cone can reach are the weighted sum, which handles both close and small
/// parts. From inside, or for transforms that are not similarities, sampling is by area only.
class Sphere final : public Quadric {
  public:
    /// Bounds as in the scene file: any order, clamped to the sphere; phiMax in degrees. `opaque` false: some rays pass
    /// the surface (alpha), so that the farther of two points in one direction is visible as well.
    Sphere(Float radius, Float zMin, Float zMax, Float phiMax, const Transform &renderFromObject,
           bool reverseOrientation, bool opaque = true);

    std::optional<ShapeSample> Sample(uint32_t primitive, const ShapeSampleContext &from,
                                      const Point2 &u) const override;
    Float PdfSolidAngle(uint32_t primitive, const ShapeSampleContext &from, const Vector3 &wi, const Point3 &pHit,
                        const Normal3 &nHit) const override;

  protected:
    Bounds3 ObjectBounds() const override;
    Roots ObjectIntersect(const glm::dvec3 &o, const glm::dvec3 &d) const override { return RoundRoots(o, d); }
    std::optional<Point2> Clip(const glm::dvec3 &p) const override;
    ObjectPoint PointAt(const Point2 &uv) const override;
    ShapeSample SampleObject(const Point2 &u) const override;
    Normal3 NormalAt(const Point3 &p) const override { return p; }

  private:
    Point2 UvOf(const glm::dvec3 &p) const;
    /// Cone of directions that hit the full sphere; none from inside.
    struct Cone {
        Float distance;
        Float sinThetaMax;
        Float oneMinusCosThetaMax;
        Float Pdf() const { return 1 / (2 * Pi * oneMinusCosThetaMax); }  ///< solid angle
    };
    std::optional<Cone> ConeFrom(const ShapeSampleContext &from) const;
    /// Near side of a full sphere, uniform in the cone.
    ShapeSample SampleNearSide(const Cone &cone, const ShapeSampleContext &from, const Point2 &u) const;
    /// First hit along a cone direction; pdf is not set.
    std::optional<ShapeSample> SampleFirstHit(const Cone &cone, const ShapeSampleContext &from, const Point2 &u) const;
    /// True if the ray from `from` to surface point p has no earlier hit on this sphere.
    bool IsMetFirst(const ShapeSampleContext &from, const Vector3 &wi, const Point3 &p) const;

    Float zMin_, zMax_, thetaZMin_, thetaZMax_;
    bool opaque_;
    Float coneShare_;     ///< probability of cone sampling from outside; 1 for a full opaque sphere
    Point3 center_;       ///< rendering space
    Float renderRadius_;  ///< rendering space, if a similarity
};

}  // namespace pbrt
