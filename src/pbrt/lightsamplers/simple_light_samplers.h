#pragma once
#include "pbrt/lightsamplers/group_light_sampler.h"
#include "pbrt/math/distributions.h"

namespace pbrt {

/// Selects all groups with equal probability.
class UniformLightSampler final : public GroupLightSampler {
  public:
    explicit UniformLightSampler(const LightGroups &groups) : GroupLightSampler(groups, true) {}
    std::optional<ChosenGroup> ChooseGroup(const LightQuery &query, const void *, Float u) const override {
        ChosenGroup chosen = SampleUniformly(query, u);
        chosen.inner = InnerNumber(query, u);
        return chosen;
    }
    Float GroupProbability(const LightQuery &, const void *, uint32_t) const override {
        return 1 / Float(groups_.Size());
    }
};

/// Selects in proportion to LightTable::PowerTowardsReceivers; uniformly if no group has power.
class PowerLightSampler : public GroupLightSampler {
  public:
    explicit PowerLightSampler(const LightGroups &groups)
        : GroupLightSampler(groups, true), table_(TableByPower(groups)) {}
    std::optional<ChosenGroup> ChooseGroup(const LightQuery &query, const void *, Float u) const final {
        const AliasTable::Sampled s = table_.Sample(u);
        return ChosenGroup{uint32_t(s.index), s.pmf, InnerNumber(query, u)};
    }
    Float GroupProbability(const LightQuery &, const void *, uint32_t group) const final {
        return table_.PMF(int(group));
    }
    void Report(nlohmann::ordered_json &json) const override;

  protected:
    static AliasTable TableByPower(const LightGroups &groups) {
        std::vector<Float> power;
        for (uint32_t g = 0; g < groups.Size(); ++g)
            power.push_back(groups.Lights().PowerTowardsReceivers(groups.Candidate(g)));
        return power.empty() ? AliasTable() : AliasTable(power);
    }

    AliasTable table_;
};

/// Returns `chosen`; if null, a sampler by power over all light components.
std::unique_ptr<LightSampler> ByPowerUnless(std::unique_ptr<LightSampler> chosen, const LightTable &lights);

}  // namespace pbrt
