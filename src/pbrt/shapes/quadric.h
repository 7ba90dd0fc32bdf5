#pragma once
#include "pbrt/math/warps.h"
#include "pbrt/shapes/shape.h"

namespace pbrt {

/// Base of sphere, disk and cylinder: one primitive in object space, placed by an affine transform. Derived classes
/// work in object space only.
///
/// Hits and samples have the same normal, flipped if exactly one of mirroring and ReverseOrientation applies. Samples
/// cover the part left by zmin, zmax, phimax and innerradius; areas and densities include the transform's scale. (Stock
/// differs in all of this: docs/reference/compatibility.md, "Area lights".)
class Quadric : public Shape {
  public:
    uint32_t PrimitiveCount() const final { return 1; }
    Bounds3 PrimitiveBounds(uint32_t) const final {
        return PlacedBounds(renderFromObject_, {{-radius_, -radius_, zMin_}, {radius_, radius_, zMax_}});
    }
    Float Area(uint32_t) const final { return area_; }
    std::optional<PrimitiveHit> Intersect(uint32_t primitive, const Ray &ray, Float tMin) const final;
    SurfacePoint Surface(uint32_t primitive, const PrimitiveHit &hit) const final;
    SurfacePoint SurfaceOnRay(uint32_t primitive, const PrimitiveHit &hit, const Ray &ray) const final;
    std::optional<ShapeSample> SampleArea(uint32_t primitive, const Point2 &u) const final;
    Float PdfArea(uint32_t primitive, const Point3 &p, const Normal3 &n) const final;

  protected:
    struct ObjectPoint {
        Point3 p{};
        Vector3 pError{};
        Normal3 n{};  ///< unit, on the side of dpdu x dpdv
        Vector3 dpdu{}, dpdv{};
        Normal3 dndu{}, dndv{};
    };
    /// Ray parameters of up to two hits with the unclipped surface, ascending.
    struct Roots {
        int count = 0;
        double t[2] = {0, 0};
    };

    /// zMin and zMax in any order; phiMax in degrees.
    Quadric(ShapeKind kind, Float radius, Float zMin, Float zMax, Float phiMax, const Transform &renderFromObject,
            bool reverseOrientation);
    /// Sets the object-space area of the clipped surface; called at the end of derived constructors.
    void SetArea(Float objectArea);

    virtual Roots ObjectIntersect(const glm::dvec3 &o, const glm::dvec3 &d) const = 0;
    /// (u, v) of a point of the unclipped surface; nullopt if clipped.
    virtual std::optional<Point2> Clip(const glm::dvec3 &p) const = 0;
    virtual ObjectPoint PointAt(const Point2 &uv) const = 0;
    /// Uniform by object-space area over the clipped surface, in object space; pdf is not set.
    virtual ShapeSample SampleObject(const Point2 &u) const = 0;
    /// Outward normal at an object-space surface point, any length.
    virtual Normal3 NormalAt(const Point3 &p) const = 0;

    /// IsInPlane of the object-space plane z = height.
    bool IsAtHeight(double height, const Point3 &p, const Vector3 &pError) const;

    const Transform &RenderFromObject() const { return renderFromObject_; }
    bool IsSimilarity() const { return isSimilarity_; }
    Float Scale() const { return scale_; }  ///< only if IsSimilarity()
    /// Unit normal in rendering space, flipped as the surface.
    Normal3 RenderNormal(const Normal3 &objectNormal) const;

    /// Hits of a line with a sphere, or a circle, about the origin: tested by the line's distance from it. Roots are
    /// symmetric about the nearest point (parameter m).
    template <class V>
    Roots RoundRoots(const V &o, const V &d) const {
        const double a = glm::dot(d, d), m = -glm::dot(o, d) / a, r = double(radius_);
        const V nearest = o + m * d;
        const double rest = r * r - glm::dot(nearest, nearest);
        if (!(rest >= 0)) return {};
        const double half = std::sqrt(rest / a), far = m >= 0 ? m + half : m - half;
        // The root nearer to the origin follows from the product of the roots, without cancellation.
        const double near = far != 0 ? (glm::dot(o, o) - r * r) / (a * far) : 0;
        return {2, {std::min(near, far), std::max(near, far)}};
    }
    bool IsFullTurn() const { return phiMax_ >= Float(6.28318); }
    bool CutsAzimuth(double phi) const { return !IsFullTurn() && phi > double(phiMax_); }

    Float radius_, zMin_, zMax_, phiMax_;  ///< phiMax_ in radians

  private:
    /// Rendering-space per object-space area for unit object normal n.
    Float AreaStretch(const Normal3 &n) const;
    Float PdfAreaAt(const Normal3 &objectNormal) const { return 1 / (objectArea_ * AreaStretch(objectNormal)); }

    Transform renderFromObject_;
    glm::dmat3 toObject_;
    glm::dvec3 origin_;
    Float determinant_;
    Float scale_;
    Float objectArea_ = 0, area_ = 0;
    Vector3 reach_{};  ///< largest coordinates
    bool isSimilarity_;
    bool flipNormal_;
};

template <class T>
T Azimuth(T x, T y) {
    T phi = std::atan2(y, x);
    return phi < 0 ? phi + 2 * std::numbers::pi_v<T> : phi;
}

/// Disk at z = height about the z axis, facing +z, cut by inner radius and phiMax.
class Disk final : public Quadric {
  public:
    /// phiMax in degrees.
    Disk(Float height, Float radius, Float innerRadius, Float phiMax, const Transform &renderFromObject,
         bool reverseOrientation)
        : Quadric(ShapeKind::Disk, radius, height, height, phiMax, renderFromObject, reverseOrientation),
          innerRadius_(std::max(innerRadius, Float(0))) {
        SetArea(phiMax_ / 2 * (radius_ * radius_ - innerRadius_ * innerRadius_));
    }
    DirectionCone NormalBounds(uint32_t) const override { return {RenderNormal({0, 0, 1}), 1}; }
    bool IsInPlane(uint32_t, const Point3 &p, const Vector3 &pError) const override {
        return IsAtHeight(double(zMin_), p, pError);
    }

  protected:
    Roots ObjectIntersect(const glm::dvec3 &o, const glm::dvec3 &d) const override {
        if (d.z == 0) return {};
        return {1, {(double(zMin_) - o.z) / d.z, 0}};
    }
    std::optional<Point2> Clip(const glm::dvec3 &p) const override {
        double r = std::sqrt(p.x * p.x + p.y * p.y), outer = double(radius_), inner = double(innerRadius_);
        if (!(r <= outer && r >= inner)) return {};
        double phi = Azimuth(p.x, p.y);
        if (CutsAzimuth(phi)) return {};
        return Point2(std::min(Float(phi / double(phiMax_)), Float(1)), Float((outer - r) / (outer - inner)));
    }
    ObjectPoint PointAt(const Point2 &uv) const override {
        Float phi = uv.x * phiMax_, cosPhi = std::cos(phi), sinPhi = std::sin(phi);
        Float r = radius_ - uv.y * (radius_ - innerRadius_);
        return {.p = {r * cosPhi, r * sinPhi, zMin_},
                .n = {0, 0, 1},
                .dpdu = Vector3(-sinPhi, cosPhi, 0) * (phiMax_ * std::max(r, Float(1e-5) * radius_)),
                .dpdv = Vector3(cosPhi, sinPhi, 0) * (innerRadius_ - radius_)};
    }
    ShapeSample SampleObject(const Point2 &u) const override {
        ShapeSample at;
        at.n = {0, 0, 1};
        Float r, phi;
        if (innerRadius_ == 0 && IsFullTurn()) {
            Point2 d = SampleUniformDiskConcentric(u) * radius_;
            at.p = {d.x, d.y, zMin_};
            r = std::sqrt(d.x * d.x + d.y * d.y);
            phi = Azimuth(d.x, d.y);
        } else {
            r = std::sqrt(Lerp(u.x, innerRadius_ * innerRadius_, radius_ * radius_));
            phi = u.y * phiMax_;
            at.p = {r * std::cos(phi), r * std::sin(phi), zMin_};
        }
        at.uv = {phi / phiMax_, (radius_ - r) / (radius_ - innerRadius_)};
        return at;
    }
    Normal3 NormalAt(const Point3 &) const override { return {0, 0, 1}; }

  private:
    Float innerRadius_;
};

/// Open cylinder about the z axis between zMin and zMax, cut at phiMax.
class Cylinder final : public Quadric {
  public:
    /// zMin and zMax in any order; phiMax in degrees.
    Cylinder(Float radius, Float zMin, Float zMax, Float phiMax, const Transform &renderFromObject,
             bool reverseOrientation)
        : Quadric(ShapeKind::Cylinder, radius, zMin, zMax, phiMax, renderFromObject, reverseOrientation) {
        SetArea((zMax_ - zMin_) * radius_ * phiMax_);
    }

  protected:
    Roots ObjectIntersect(const glm::dvec3 &o, const glm::dvec3 &d) const override {
        return RoundRoots(glm::dvec2(o), glm::dvec2(d));
    }
    std::optional<Point2> Clip(const glm::dvec3 &p) const override {
        double z0 = double(zMin_), z1 = double(zMax_);
        if (p.z < z0 || p.z > z1) return {};
        double phi = Azimuth(p.x, p.y);
        if (CutsAzimuth(phi)) return {};
        return Point2(std::min(Float(phi / double(phiMax_)), Float(1)), Float((p.z - z0) / (z1 - z0)));
    }
    ObjectPoint PointAt(const Point2 &uv) const override {
        double phi = double(uv.x) * double(phiMax_);
        auto cosPhi = Float(std::cos(phi)), sinPhi = Float(std::sin(phi));
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
    ShapeSample SampleObject(const Point2 &u) const override {
        ObjectPoint at = PointAt({u.y, u.x});
        return {at.p, at.pError, at.n, {u.y, u.x}, 0};
    }
    Normal3 NormalAt(const Point3 &p) const override { return {p.x, p.y, 0}; }
};

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

    Float thetaZMin_, thetaZMax_;
    bool opaque_;
    Float coneShare_;     ///< probability of cone sampling from outside; 1 for a full opaque sphere
    Point3 center_;       ///< rendering space
    Float renderRadius_;  ///< rendering space, if a similarity
};

}  // namespace pbrt
