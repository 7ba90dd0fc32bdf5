#pragma once
#include "pbrt/core/ids.h"
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

}  // namespace pbrt
