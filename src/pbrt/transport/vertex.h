#pragma once
#include "pbrt/bxdfs/bsdf.h"
#include "pbrt/lightsamplers/light_sampler.h"
#include "pbrt/scene/shading.h"
#include "pbrt/shapes/shape.h"

namespace pbrt {

/// A scattering surface vertex of a path.
struct PathVertex {
    SurfacePoint point;
    Bsdf bsdf;
};

/// Origin of shadow rays and light samples.
inline LightSampleContext LightContextAt(const SurfacePoint &point) {
    return {point.p, point.pError, point.n, point.shading.n, point.time};
}

/// Light sampling receiver for this BSDF: as in stock pbrt-v4, the side of the surface that scatters. Matters only
/// where error bounds are as large as the width of a curve.
inline LightSampleContext ScatteringContextAt(const Scene &scene, const SurfacePoint &point, const Bsdf &bsdf) {
    LightSampleContext from = LightContextAt(point);
    const bool reflects = IsReflective(bsdf.Flags());
    if (scene.ShapeOf(point.shape).FacesRay() && reflects != IsTransmissive(bsdf.Flags()))
        from.p = point.OffsetOrigin(reflects ? point.wo : -point.wo);
    return from;
}

/// Cosine for light from `wo` scattered towards `wi` on a light path. Camera paths use the cosine at the shading
/// normal. Consistent light paths use the cosine at the geometric normal, times the ratio of both on the incident side
/// (Veach 1997, section 5.3.2).
inline Float AdjointCosine(const SurfacePoint &point, const Vector3 &wo, const Vector3 &wi) {
    const Float geometric = AbsDot(wo, point.n);
    return geometric > 0 ? AbsDot(wo, point.shading.n) * AbsDot(wi, point.n) / geometric : 0;
}

/// Light sampler query at a vertex. Refers to the vertex's BSDF and `lambda`, which must outlive it.
inline LightQuery LightQueryAt(const PathVertex &vertex, const SampledWavelengths &lambda, int depth) {
    const SurfacePoint &point = vertex.point;
    return {point.p, point.wo,     point.n, point.shading.n, IsTransmissive(vertex.bsdf.Flags()), {}, point.time,
            depth,   &vertex.bsdf, &lambda, point.pError};
}

/// Query at a medium point with outgoing direction wo. Refers to the phase function and `lambda`.
inline LightQuery LightQueryInMedium(const Point3 &p, const Vector3 &wo, MediumId medium, const HenyeyGreenstein &phase,
                                     Float time, const SampledWavelengths &lambda, int depth) {
    LightQuery query{.p = p, .wo = wo, .transmits = true, .medium = medium, .time = time, .depth = depth};
    query.lambda = &lambda;
    query.phase = &phase;
    return query;
}

}  // namespace pbrt
