#pragma once
#include <optional>

#include "pbrt/math/bounds.h"
#include "pbrt/math/transform.h"
#include "pbrt/shapes/surface_point.h"

namespace pbrt {

/// A point drawn on a shape. `pdf` is in the measure that the sampling function names.
struct ShapeSample {
    Point3 p{};
    Vector3 pError{};
    Normal3 n{};  ///< oriented like SurfacePoint::n
    Point2 uv{};
    Float pdf = 0;
};

/// The point from which a shape is sampled. n and ns are zero in a medium or if unknown; ns then has no influence.
struct ShapeSampleContext {
    Point3 p{};
    Vector3 pError{};
    Normal3 n{}, ns{};
    Float time = 0;
    Point3 OffsetOrigin(const Vector3 &w) const { return OffsetRayOrigin(p, pError, n, w); }
};

/// A hit in a primitive's own parameters: barycentric (b1, b2) for triangles, (u, v) for patches, (u, v) of
/// pbrt-v4-format §6 for quadrics.
struct PrimitiveHit {
    Float t = 0;
    Float u = 0, v = 0;
};

/// How the accelerator should trace a shape.
enum class ShapeKind { TriangleMesh, BilinearMesh, Sphere, Disk, Cylinder, Curves };

/// A quadric (one primitive) or a mesh (many), in rendering space. Immutable.
class Shape {
  public:
    virtual ~Shape() = default;
    virtual ShapeKind Kind() const = 0;
    virtual uint32_t PrimitiveCount() const = 0;
    virtual Bounds3 PrimitiveBounds(uint32_t primitive) const = 0;
    virtual Float Area(uint32_t primitive) const = 0;
    /// Cone that holds all (oriented) normals of the primitive.
    virtual DirectionCone NormalBounds(uint32_t primitive) const = 0;

    /// Ray against one primitive, nearest t in (tMin, tMax). Used for kinds that Embree does not trace natively and by
    /// tests as a slow reference. The direction need not be unit.
    virtual std::optional<PrimitiveHit> Intersect(uint32_t primitive, const Point3 &o, const Vector3 &d, Float tMin,
                                                  Float tMax) const = 0;

    /// Fills everything but ids, wo, time, t and footprints.
    virtual SurfacePoint Surface(uint32_t primitive, const PrimitiveHit &hit) const = 0;
    /// The same for the hit of a ray, in the shape's space, which gives digits that the float parameters of a hit on a
    /// large primitive do not have.
    virtual SurfacePoint SurfaceOnRay(uint32_t primitive, const PrimitiveHit &hit, const Point3 &o,
                                      const Vector3 &d) const = 0;
    /// True for curves, which turn towards the ray.
    bool FacesRay() const { return facesRay_; }
    /// Only the texture coordinates, for alpha tests.
    virtual Point2 Uv(uint32_t primitive, const PrimitiveHit &hit) const = 0;

    /// A point, uniform by area where that is simple. pdf is its density by area.
    virtual std::optional<ShapeSample> SampleArea(uint32_t primitive, const Point2 &u) const = 0;
    /// Density by area with which SampleArea finds a point p of the primitive, whose normal is n.
    virtual Float PdfArea(uint32_t primitive, const Point3 &p, const Normal3 &n) const = 0;
    /// A point for a shape seen from `from`. pdf is its density by solid angle. Empty if nothing can be drawn.
    virtual std::optional<ShapeSample> Sample(uint32_t primitive, const ShapeSampleContext &from,
                                              const Point2 &u) const = 0;
    /// Density (solid angle) with which Sample(from) finds the direction wi; the ray from `from` along wi is known to
    /// hit this primitive at pHit with normal nHit.
    virtual Float PdfSolidAngle(uint32_t primitive, const ShapeSampleContext &from, const Vector3 &wi,
                                const Point3 &pHit, const Normal3 &nHit) const = 0;

  protected:
    explicit Shape(bool facesRay = false) : facesRay_(facesRay) {}

  private:
    bool facesRay_;
};

/// Density by solid angle at `from` of a point that was drawn with `pdfArea` by area; wi unit towards it. 0 if the
/// surface is seen edge-on.
inline Float SolidAngleDensity(Float pdfArea, const Point3 &from, const Vector3 &wi, const Point3 &p,
                               const Normal3 &n) {
    Float pdf = pdfArea * DistanceSquared(from, p) / AbsDot(n, wi);
    return std::isfinite(pdf) ? pdf : 0;
}

/// A sample drawn by area, with its density turned to solid angle at `from`; empty if that is 0 or infinite.
inline std::optional<ShapeSample> WithSolidAngleDensity(std::optional<ShapeSample> s, const Point3 &from) {
    if (!s) return {};
    Vector3 wi = s->p - from;
    Float distance = Length(wi);
    if (!(distance > 0)) return {};
    s->pdf = SolidAngleDensity(s->pdf, from, wi / distance, s->p, s->n);
    if (!(s->pdf > 0)) return {};
    return s;
}

}  // namespace pbrt
