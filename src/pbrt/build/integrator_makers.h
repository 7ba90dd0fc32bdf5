#pragma once
#include <limits>

#include "pbrt/build/integrator_builder.h"

namespace pbrt {

inline constexpr Range<int> kCounts{1, std::numeric_limits<int>::max()};
inline constexpr Range<Float> kPositive = Positive(std::numeric_limits<Float>::max());

struct DepthParams {
    int maxDepth = 5;
    template <class V>
    void Describe(V &&v) {
        v("maxdepth", maxDepth, Range<int>{0, std::numeric_limits<int>::max()},
          "largest number of scattering events of a path; --maxdepth overrides it");
    }
    int MaxDepth(const IntegratorReading &r) const { return r.options.maxDepth.value_or(maxDepth); }
};

/// Parses an integrator's light sampler; empty on errors, which are in the sink.
std::optional<LightSelection> ReadLights(const ParamSet &set, const IntegratorReading &r,
                                         const LightSelectionParams &defaults = {});
std::unique_ptr<LightSampler> MakeLights(const LightSamplerSpec &chosen, const PluginRegistry &registry,
                                         const LightTable &table);

/// lightpath, bdpt, mlt, sppm.
void AddLightPathIntegrators(IntegratorTable &table);

}  // namespace pbrt
