#pragma once
#include <limits>

#include "pbrt/build/integrator_builder.h"

namespace pbrt {

// What the makers of integrators share.

struct DepthParams {
    int maxDepth = 5;
    template <class V>
    void Describe(V &&v) {
        v("maxdepth", maxDepth, Range<int>{0, std::numeric_limits<int>::max()},
          "largest number of scattering events of a path; --maxdepth overrides it");
    }
    int MaxDepth(const IntegratorReading &r) const { return r.options.maxDepth.value_or(maxDepth); }
};

/// Reads the light sampler of an integrator; nothing is returned after errors, which went to the sink.
std::optional<LightSelection> ReadLights(const ParamSet &set, const IntegratorReading &r,
                                         const LightSelectionParams &defaults = {});
std::unique_ptr<LightSampler> MakeLights(const LightSamplerSpec &chosen, const PluginRegistry &registry,
                                         const LightTable &table);

/// lightpath, bdpt, mlt, sppm.
void AddLightPathIntegrators(IntegratorTable &table);

}  // namespace pbrt
