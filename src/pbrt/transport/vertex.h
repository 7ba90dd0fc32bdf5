#pragma once
#include "pbrt/bxdfs/bsdf.h"
#include "pbrt/scene/shading.h"

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

}  // namespace pbrt
