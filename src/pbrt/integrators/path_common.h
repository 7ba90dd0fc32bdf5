#pragma once
#include "pbrt/bxdfs/bsdf.h"
#include "pbrt/integrators/pixel_integrator.h"
#include "pbrt/scene/footprint.h"
#include "pbrt/scene/shading.h"

namespace pbrt {

/// The end of a path so far: the ray that looks for the next vertex.
struct PathRay {
    Ray ray;
    RayDifferential differential;

    /// Goes on behind a surface that does not scatter.
    void PassThrough(const SurfacePoint &point) {
        Vector3 d = ray.d;
        ray = point.SpawnRay(d);
        differential.rxOrigin += d * point.t;
        differential.ryOrigin += d * point.t;
    }

    /// Leaves the surface by a BSDF sample; differentials survive specular bounces only.
    void Scatter(const SurfacePoint &point, const BsdfSample &sample) {
        if (differential.valid) {
            if (!IsSpecular(sample.flags)) differential.valid = false;
            else if (IsTransmissive(sample.flags)) differential = TransmitDifferential(point, differential, sample.wi, sample.eta);
            else differential = ReflectDifferential(point, differential, sample.wi);
        }
        ray = point.SpawnRay(sample.wi);
    }
};

/// Fills the footprint where somebody looks at it: the point's material, or the next surface on a specular path.
inline void FindFootprint(const IntegratorContext &context, SurfacePoint &point, PathRay &path) {
    if (!context.needsFootprints) path.differential.valid = false;
    else if (path.differential.valid || context.scene.NeedsFootprintAt(point))
        ComputeFootprint(point, path.differential, context.camera, context.samplesPerPixel);
}

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

inline LightQuery LightQueryAt(const SurfacePoint &point, const Bsdf &bsdf, const SampledWavelengths &lambda, int depth) {
    return {point.p, point.wo, point.n, point.shading.n, IsTransmissive(bsdf.Flags()), {}, point.time, depth,
            &bsdf,   &lambda,  point.pError};
}

}  // namespace pbrt
