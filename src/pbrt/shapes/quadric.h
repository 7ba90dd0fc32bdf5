#pragma once
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
    Bounds3 PrimitiveBounds(uint32_t primitive) const final;
    Float Area(uint32_t) const final { return area_; }
    std::optional<PrimitiveHit> Intersect(uint32_t primitive, const Point3 &o, const Vector3 &d, Float tMin,
                                          Float tMax) const final;
    SurfacePoint Surface(uint32_t primitive, const PrimitiveHit &hit) const final;
    SurfacePoint SurfaceOnRay(uint32_t primitive, const PrimitiveHit &hit, const Point3 &o,
                              const Vector3 &d) const final;
    Point2 Uv(uint32_t, const PrimitiveHit &hit) const final { return {hit.u, hit.v}; }
    std::optional<ShapeSample> SampleArea(uint32_t primitive, const Point2 &u) const final;
    Float PdfArea(uint32_t primitive, const Point3 &p, const Normal3 &n) const final;
    std::optional<ShapeSample> Sample(uint32_t primitive, const ShapeSampleContext &from,
                                      const Point2 &u) const override;
    Float PdfSolidAngle(uint32_t primitive, const ShapeSampleContext &from, const Vector3 &wi, const Point3 &pHit,
                        const Normal3 &nHit) const override;

  protected:
    struct ObjectPoint {
        Point3 p{};
        Vector3 pError{};
        Normal3 n{};  ///< unit, on the side of dpdu x dpdv
        Vector3 dpdu{}, dpdv{};
        Normal3 dndu{}, dndv{};
    };
    struct ObjectSample {
        Point3 p{};
        Vector3 pError{};
        Normal3 n{};
        Point2 uv{};
    };
    /// Ray parameters of up to two hits with the unclipped surface, ascending.
    struct Roots {
        int count = 0;
        double t[2] = {0, 0};
    };

    Quadric(const Transform &renderFromObject, bool reverseOrientation);
    /// Sets the object-space area of the clipped surface; called at the end of derived constructors.
    void SetArea(Float objectArea);

    virtual Bounds3 ObjectBounds() const = 0;
    virtual Roots ObjectIntersect(const glm::dvec3 &o, const glm::dvec3 &d) const = 0;
    /// (u, v) of a point of the unclipped surface; nullopt if clipped.
    virtual std::optional<Point2> Clip(const glm::dvec3 &p) const = 0;
    virtual ObjectPoint PointAt(const Point2 &uv) const = 0;
    /// Uniform by object-space area over the clipped surface.
    virtual ObjectSample SampleObject(const Point2 &u) const = 0;
    /// Outward normal at an object-space surface point, any length.
    virtual Normal3 NormalAt(const Point3 &p) const = 0;

    const Transform &RenderFromObject() const { return renderFromObject_; }
    bool IsSimilarity() const { return isSimilarity_; }
    Float Scale() const { return scale_; }  ///< only if IsSimilarity()
    /// Unit normal in rendering space, flipped as the surface.
    Normal3 RenderNormal(const Normal3 &objectNormal) const;

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

inline bool IsFullTurn(Float phiMax) { return phiMax >= Float(6.28318); }
inline bool CutsAzimuth(Float phiMax, double phi) { return !IsFullTurn(phiMax) && phi > double(phiMax); }

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
