#pragma once
#include <optional>

#include "pbrt/core/ids.h"
#include "pbrt/math/bounds.h"
#include "pbrt/math/transform.h"

namespace pbrt {

/// Surface point for integrators, with ids that the scene resolves.
struct SurfacePoint {
    Point3 p{};
    Vector3 pError{};  ///< componentwise bound on |true p - p|
    Vector3 wo{};      ///< unit, back along the ray
    Normal3 n{};       ///< geometric, unit, oriented by the shape (ReverseOrientation, handedness, vertex normals)
    Point2 uv{};
    Vector3 dpdu{}, dpdv{};
    Normal3 dndu{}, dndv{};
    struct Shading {
        Normal3 n{};  ///< unit, same side as the geometric n unless vertex normals decided the side
        Vector3 dpdu{}, dpdv{};
        Normal3 dndu{}, dndv{};
    } shading;
    Float time = 0;
    Float t = 0;  ///< ray parameter

    ShapeId shape{};
    uint32_t primitive = 0;
    MaterialId material{};
    LightId light{};                           ///< area light on this primitive, NoLight if none
    MediumId insideMedium{}, outsideMedium{};  ///< on the side opposite to n, and on the side of n

    // Filter footprint: derivatives per pixel step in x and y, 0 if unknown.
    Vector3 dpdx{}, dpdy{};
    Float dudx = 0, dvdx = 0, dudy = 0, dvdy = 0;

    /// Origin of a ray towards w, offset by the error bound.
    Point3 OffsetOrigin(const Vector3 &w) const { return OffsetRayOrigin(p, pError, n, w); }
    MediumId MediumTowards(const Vector3 &w) const { return Dot(w, n) > 0 ? outsideMedium : insideMedium; }
    Ray SpawnRay(const Vector3 &d) const { return {OffsetOrigin(d), d, Infinity, time, MediumTowards(d)}; }
};

/// Transforms a surface point by an instance's placement: geometry and error bounds are transformed, normals keep their
/// side, all else is copied. Error bounds include transforming outgoing rays back by the inverse in single precision.
SurfacePoint TransformSurface(const Transform &t, const SurfacePoint &s);

/// Bounds of a transformed box, with the rounding errors of its corners.
Bounds3 PlacedBounds(const Transform &t, const Bounds3 &b);

/// Derivatives of the unit normal n from first and second derivatives of the position (Weingarten equations).
inline void NormalDerivatives(const Vector3 &dpdu, const Vector3 &dpdv, const Vector3 &d2pduu, const Vector3 &d2pduv,
                              const Vector3 &d2pdvv, const Normal3 &n, Normal3 *dndu, Normal3 *dndv) {
    Float uu = Dot(dpdu, dpdu), uv = Dot(dpdu, dpdv), vv = Dot(dpdv, dpdv);
    // Fourth powers of lengths may leave single precision.
    using D = double;
    const D determinant = D(uu) * D(vv) - D(uv) * D(uv), inverse = determinant == 0 ? 0 : 1 / determinant;
    auto combined = [&](D e, D f) {
        return Float((f * D(uv) - e * D(vv)) * inverse) * dpdu + Float((e * D(uv) - f * D(uu)) * inverse) * dpdv;
    };
    const D f(Dot(n, d2pduv));
    *dndu = combined(D(Dot(n, d2pduu)), f);
    *dndv = combined(f, D(Dot(n, d2pdvv)));
}

/// Derivative of n / |n| where n has derivative dn; 0 if n is 0.
inline Normal3 UnitNormalDerivative(const Normal3 &n, const Normal3 &dn) {
    const Float length = Length(n);
    if (!(length > 0)) return Normal3(0);
    const Normal3 unit = n / length, change = dn / length;
    return change - unit * Dot(unit, change);
}

/// A sampled point of a shape. The sampling function defines the measure of `pdf`.
struct ShapeSample {
    Point3 p{};
    Vector3 pError{};
    Normal3 n{};  ///< oriented like SurfacePoint::n
    Point2 uv{};
    Float pdf = 0;
};

/// Reference point of sampling. n and ns are zero in a medium or if unknown; a zero ns is ignored.
struct ShapeSampleContext {
    Point3 p{};
    Vector3 pError{};
    Normal3 n{}, ns{};
    Float time = 0;
    Point3 OffsetOrigin(const Vector3 &w) const { return OffsetRayOrigin(p, pError, n, w); }
};

/// Hit in the primitive's parameters: barycentric (b1, b2) for triangles, (u, v) for patches and quadrics (§6).
struct PrimitiveHit {
    Float t = 0;
    Float u = 0, v = 0;
};

enum class ShapeKind { TriangleMesh, BilinearMesh, Sphere, Disk, Cylinder, Curves };

/// A quadric (one primitive) or a mesh (many), in rendering space. Immutable.
class Shape {
  public:
    virtual ~Shape() = default;
    ShapeKind Kind() const { return kind_; }
    virtual uint32_t PrimitiveCount() const = 0;
    virtual Bounds3 PrimitiveBounds(uint32_t primitive) const = 0;
    virtual Float Area(uint32_t) const { return 0; }  ///< only of shapes that are sampled
    /// Cone that contains all (oriented) normals of the primitive.
    virtual DirectionCone NormalBounds(uint32_t) const { return DirectionCone::EntireSphere(); }

    /// Nearest hit with one primitive, t in (tMin, ray.tMax). Used for kinds that Embree does not trace natively, and
    /// as a reference in tests. The direction need not be unit.
    virtual std::optional<PrimitiveHit> Intersect(uint32_t primitive, const Ray &ray, Float tMin) const = 0;
    /// A hit from Embree with the correct (u, v). Embree returns those of a corner if twice the cross product of two
    /// edges, times the ray direction, is below 1e-18: for small primitives, and in instances that enlarge them.
    virtual PrimitiveHit Completed(uint32_t, const PrimitiveHit &hit, const Ray &) const { return hit; }

    /// Fills all but ids, wo, time, t and footprints. Empty for curves, which face the ray.
    virtual SurfacePoint Surface(uint32_t, const PrimitiveHit &) const { return {}; }
    /// Surface for a ray hit in the shape's space, also accurate where float hit parameters are too coarse.
    virtual SurfacePoint SurfaceOnRay(uint32_t primitive, const PrimitiveHit &hit, const Ray &ray) const = 0;
    /// True if the primitive is flat and, but for rounding, its plane passes through a point known up to `pError`.
    virtual bool IsInPlane(uint32_t, const Point3 & /*p*/, const Vector3 & /*pError*/) const { return false; }
    /// True for curves, which face the ray.
    bool FacesRay() const { return kind_ == ShapeKind::Curves; }
    virtual Point2 Uv(uint32_t, const PrimitiveHit &hit) const { return {hit.u, hit.v}; }

    /// Samples a point, uniform by area where that is simple. pdf by area. Empty for shapes that are not sampled.
    virtual std::optional<ShapeSample> SampleArea(uint32_t, const Point2 &) const { return {}; }
    /// Density of SampleArea, by area, at point p of the primitive with normal n.
    virtual Float PdfArea(uint32_t, const Point3 & /*p*/, const Normal3 & /*n*/) const { return 0; }
    /// Samples a point as seen from `from`, by default with SampleArea. pdf by solid angle. Empty if sampling fails.
    virtual std::optional<ShapeSample> Sample(uint32_t primitive, const ShapeSampleContext &from,
                                              const Point2 &u) const {
        std::optional<ShapeSample> s = SampleArea(primitive, u);
        if (!s) return {};
        const Vector3 d = s->p - from.p;
        const Float distance = Length(d);
        if (!(distance > 0)) return {};
        s->pdf = SolidAngleDensity(s->pdf, from.p, d / distance, s->p, s->n);
        return s->pdf > 0 ? s : std::nullopt;
    }
    /// Density of Sample(from), by solid angle, in direction wi; the ray along wi must hit this primitive at pHit with
    /// normal nHit.
    virtual Float PdfSolidAngle(uint32_t primitive, const ShapeSampleContext &from, const Vector3 &wi,
                                const Point3 &pHit, const Normal3 &nHit) const {
        return SolidAngleDensity(PdfArea(primitive, pHit, nHit), from.p, wi, pHit, nHit);
    }

  protected:
    explicit Shape(ShapeKind kind) : kind_(kind) {}
    /// True if a point, known up to `pError`, is in a plane of normal n, but for rounding of the primitive's placement.
    /// `height`: the point's distance from the plane times |n|. `rounded`: coordinates whose rounding moves the plane
    /// at the point. `reach`: largest coordinate of the primitive. pError counts to a limit relative to `reach`: far
    /// from the world's origin it would hide surfaces near the camera.
    static bool IsRounding(double height, const glm::dvec3 &n, const Vector3 &rounded, Float reach,
                           const Vector3 &pError);

  private:
    /// Converts a density by area to solid angle at `from`; wi is the unit direction to the point. 0 if edge-on.
    static Float SolidAngleDensity(Float pdfArea, const Point3 &from, const Vector3 &wi, const Point3 &p,
                                   const Normal3 &n) {
        Float pdf = pdfArea * DistanceSquared(from, p) / AbsDot(n, wi);
        return std::isfinite(pdf) ? pdf : 0;
    }

    ShapeKind kind_;
};

}  // namespace pbrt
