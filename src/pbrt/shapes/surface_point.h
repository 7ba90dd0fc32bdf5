#pragma once
#include "pbrt/core/ids.h"
#include "pbrt/math/transform.h"

namespace pbrt {

/// A point on a surface for the integrators. It holds ids only, which the scene resolves.
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
    MediumId insideMedium{}, outsideMedium{};  ///< on the side that n points away from, and on the other

    // Filter footprint: derivatives by one pixel step in x and y, 0 if unknown.
    Vector3 dpdx{}, dpdy{};
    Float dudx = 0, dvdx = 0, dudy = 0, dvdy = 0;

    /// Start of a ray that leaves towards w, off the surface by the error bound.
    Point3 OffsetOrigin(const Vector3 &w) const { return OffsetRayOrigin(p, pError, n, w); }
    MediumId MediumTowards(const Vector3 &w) const { return Dot(w, n) > 0 ? outsideMedium : insideMedium; }
    Ray SpawnRay(const Vector3 &d) const { return {OffsetOrigin(d), d, Infinity, time, MediumTowards(d)}; }
};

/// The same point after its shape was moved by `t` (an instance's placement): geometry and error bounds are
/// transformed, normals keep the side they are on, everything else is copied. The bounds also cover what is lost when a
/// ray that starts here is taken back through the inverse of `t` in single precision.
SurfacePoint TransformSurface(const Transform &t, const SurfacePoint &s);

}  // namespace pbrt
