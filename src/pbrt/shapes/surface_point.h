#pragma once
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
    Float e = Dot(n, d2pduu), f = Dot(n, d2pduv), g = Dot(n, d2pdvv);
    Float determinant = DifferenceOfProducts(uu, vv, uv, uv);
    Float inverse = determinant == 0 ? 0 : 1 / determinant;
    *dndu = ((f * uv - e * vv) * dpdu + (e * uv - f * uu) * dpdv) * inverse;
    *dndv = ((g * uv - f * vv) * dpdu + (f * uv - g * uu) * dpdv) * inverse;
}

}  // namespace pbrt
