#pragma once
#include "pbrt/lightsamplers/group_light_sampler.h"
#include "pbrt/math/distributions.h"

namespace pbrt {

class UniformLightSampler final : public GroupLightSampler {
  public:
    explicit UniformLightSampler(const LightGroups &groups);
    std::optional<ChosenGroup> ChooseGroup(const LightQuery &query, const void *weights, Float u) const override;
    Float GroupProbability(const LightQuery &query, const void *weights, uint32_t group) const override;

  private:
    Float pmf_;
};

/// Selects in proportion to LightCandidate::power; uniformly if no group has power.
class PowerLightSampler final : public GroupLightSampler {
  public:
    explicit PowerLightSampler(const LightGroups &groups);
    std::optional<ChosenGroup> ChooseGroup(const LightQuery &query, const void *weights, Float u) const override;
    Float GroupProbability(const LightQuery &query, const void *weights, uint32_t group) const override;
    void Report(nlohmann::ordered_json &json) const override;

  private:
    AliasTable table_;
};

/// Returns `chosen`; if null, a sampler by power over all light components.
std::unique_ptr<LightSampler> ByPowerUnless(std::unique_ptr<LightSampler> chosen, const LightTable &lights);

}  // namespace pbrt
