#pragma once
#include "pbrt/lightsamplers/light_sampler.h"
#include "pbrt/paths/vertex.h"

namespace pbrt {

/// The query for a light sampler at a vertex. It refers to the vertex's BSDF and to `lambda`, which must outlive it.
inline LightQuery LightQueryAt(const PathVertex &vertex, const SampledWavelengths &lambda, int depth) {
    const SurfacePoint &point = vertex.point;
    return {point.p, point.wo,     point.n, point.shading.n, IsTransmissive(vertex.bsdf.Flags()), {}, point.time,
            depth,   &vertex.bsdf, &lambda, point.pError};
}

}  // namespace pbrt
