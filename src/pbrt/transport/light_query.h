#pragma once
#include "pbrt/lightsamplers/light_sampler.h"
#include "pbrt/transport/vertex.h"

namespace pbrt {

/// The query for a light sampler at a vertex. It refers to the vertex's BSDF and to `lambda`, which must outlive it.
inline LightQuery LightQueryAt(const PathVertex &vertex, const SampledWavelengths &lambda, int depth) {
    const SurfacePoint &point = vertex.point;
    return {point.p, point.wo,     point.n, point.shading.n, IsTransmissive(vertex.bsdf.Flags()), {}, point.time,
            depth,   &vertex.bsdf, &lambda, point.pError};
}

/// The query at a place in a medium, seen from direction wo. It refers to the phase function and to `lambda`.
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
