#pragma once
#include "pbrt/lights/light_table.h"
#include "pbrt/lightsamplers/light_sampler.h"
#include "pbrt/math/distributions.h"

namespace pbrt {

/// Every light is as likely as any other.
class UniformLightSampler final : public LightSampler {
  public:
    explicit UniformLightSampler(std::span<const LightCandidate> candidates);

  private:
    std::optional<SampledLight> Choose(const LightQuery &query, const void *weights, Float u) const override;
    Float Probability(const LightQuery &query, const void *weights, LightId light) const override;
    uint32_t count_;
    Float pmf_;
};

/// In proportion to LightCandidate::power; uniform if no light has any.
class PowerLightSampler final : public LightSampler {
  public:
    explicit PowerLightSampler(std::span<const LightCandidate> candidates);
    void Report(nlohmann::ordered_json &json) const override;

  private:
    std::optional<SampledLight> Choose(const LightQuery &query, const void *weights, Float u) const override;
    Float Probability(const LightQuery &query, const void *weights, LightId light) const override;
    AliasTable table_;
};

}  // namespace pbrt
