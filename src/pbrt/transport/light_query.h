#pragma once
#include "pbrt/lightsamplers/light_sampler.h"
#include "pbrt/transport/vertex.h"

namespace pbrt {

/// Light sampler query at a vertex. Refers to the vertex's BSDF and `lambda`, which must outlive it.
inline LightQuery LightQueryAt(const PathVertex &vertex, const SampledWavelengths &lambda, int depth) {
    const SurfacePoint &point = vertex.point;
    return {point.p, point.wo,     point.n, point.shading.n, IsTransmissive(vertex.bsdf.Flags()), {}, point.time,
            depth,   &vertex.bsdf, &lambda, point.pError};
}

/// Query at a medium point with outgoing direction wo. Refers to the phase function and `lambda`.
inline LightQuery LightQueryInMedium(const Point3 &p, const Vector3 &wo, MediumId medium, const HenyeyGreenstein &phase,
                                     Float time, const SampledWavelengths &lambda, int depth) {
    LightQuery query;
    query.p = p;
    query.wo = wo;
    query.transmits = true;
    query.medium = medium;
    query.time = time;
    query.depth = depth;
    query.phase = &phase;
    query.lambda = &lambda;
    return query;
}

}  // namespace pbrt
