#pragma once
#include "pbrt/lightsamplers/light_query.h"

namespace pbrt {

/// What light sampling needs at a vertex. It is kept until the next vertex, because the MIS weight of emission there
/// depends on the probabilities of the lights here.
struct VertexSelection {
    LightQuery query;
    LightSampleContext from;
    LightMemory memory;
    LightDistribution lights;

    void Prepare(const LightSampler &sampler, const LightQuery &q, const LightSampleContext &at) {
        query = q;
        from = at;
        lights = sampler.At(query, memory);
    }
    void Prepare(const LightSampler &sampler, const PathVertex &vertex, const SampledWavelengths &lambda, int depth) {
        Prepare(sampler, LightQueryAt(vertex, lambda, depth), LightContextAt(vertex.point));
    }
};

}  // namespace pbrt
