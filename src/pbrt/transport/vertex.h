#pragma once
#include "pbrt/bxdfs/bsdf.h"
#include "pbrt/scene/shading.h"
#include "pbrt/shapes/surface_point.h"

namespace pbrt {

/// A place on a path that scatters light.
struct PathVertex {
    SurfacePoint point;
    Bsdf bsdf;
};

/// Where shadow rays and light samples start.
inline LightSampleContext LightContextAt(const SurfacePoint &point) {
    return {point.p, point.pError, point.n, point.shading.n, point.time};
}

/// Where lights are sampled from for this BSDF: as in stock pbrt-v4 the side of the surface that scatters. It matters
/// only where error bounds are as large as a curve is wide.
inline LightSampleContext ScatteringContextAt(const Scene &scene, const SurfacePoint &point, const Bsdf &bsdf) {
    LightSampleContext from = LightContextAt(point);
    const bool reflects = IsReflective(bsdf.Flags());
    if (scene.ShapeOf(point.shape).FacesRay() && reflects != IsTransmissive(bsdf.Flags()))
        from.p = point.OffsetOrigin(reflects ? point.wo : -point.wo);
    return from;
}

/// The cosine for light that comes from `wo` and is scattered towards `wi` on a path that begins at a light. Camera
/// paths use the cosine at the shading normal. For both kinds of paths to make the same picture, light paths use the
/// cosine at the geometric normal, times the ratio of both cosines on the side that the light comes from (Veach 1997,
/// section 5.3.2).
inline Float AdjointCosine(const SurfacePoint &point, const Vector3 &wo, const Vector3 &wi) {
    const Float geometric = AbsDot(wo, point.n);
    return geometric > 0 ? AbsDot(wo, point.shading.n) * AbsDot(wi, point.n) / geometric : 0;
}

}  // namespace pbrt
