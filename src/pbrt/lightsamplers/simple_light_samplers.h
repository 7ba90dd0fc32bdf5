#pragma once
#include "pbrt/lights/light_table.h"
#include "pbrt/lightsamplers/light_sampler.h"
#include "pbrt/math/distributions.h"

namespace pbrt {

/// Every light is as likely as any other.
class UniformLightSampler final : public LightSampler {
  public:
    explicit UniformLightSampler(std::span<const LightCandidate> candidates);
    std::optional<SampledLight> Sample(const LightQuery &query, Float u) const override;
    Float PMF(const LightQuery &query, LightId light) const override;

  private:
    uint32_t count_;
    Float pmf_;
};

/// In proportion to LightCandidate::power; uniform if no light has any.
class PowerLightSampler final : public LightSampler {
  public:
    explicit PowerLightSampler(std::span<const LightCandidate> candidates);
    std::optional<SampledLight> Sample(const LightQuery &query, Float u) const override;
    Float PMF(const LightQuery &query, LightId light) const override;
    void Report(nlohmann::ordered_json &json) const override;

  private:
    AliasTable table_;
};

}  // namespace pbrt
