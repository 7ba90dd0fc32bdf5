#pragma once
#include "pbrt/bxdfs/bsdf.h"
#include "pbrt/integrators/integrator.h"
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
        if (differential.valid) {
            differential.rxOrigin += d * point.t;
            differential.ryOrigin += d * point.t;
        }
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

inline LightSampleContext LightContextAt(const SurfacePoint &point) {
    return {point.p, point.pError, point.n, point.shading.n, point.time};
}

inline LightQuery LightQueryAt(const SurfacePoint &point, const Bsdf &bsdf, const SampledWavelengths &lambda, int depth) {
    return {point.p, point.wo, point.n, point.shading.n, IsTransmissive(bsdf.Flags()), {}, point.time, depth,
            &bsdf,   &lambda,  point.pError};
}

}  // namespace pbrt
