#include "pbrt/lightsamplers/simple_light_samplers.h"

#include <nlohmann/json.hpp>

namespace pbrt {

UniformLightSampler::UniformLightSampler(const LightGroups &groups)
    : GroupLightSampler(groups, true), pmf_(groups.Size() > 0 ? 1 / Float(groups.Size()) : 0) {}

std::optional<GroupLightSampler::ChosenGroup> UniformLightSampler::ChooseGroup(const LightQuery &query, const void *,
                                                                               Float u) const {
    // In double: a float times a large count could round up to the next group.
    const size_t count = groups_.Size();
    const auto i = size_t(double(u) * double(count));
    return ChosenGroup{uint32_t(std::min(i, count - 1)), pmf_, InnerNumber(query, u)};
}

Float UniformLightSampler::GroupProbability(const LightQuery &, const void *, uint32_t) const { return pmf_; }

PowerLightSampler::PowerLightSampler(const LightGroups &groups) : GroupLightSampler(groups, true) {
    std::vector<Float> power;
    power.reserve(groups.Size());
    for (uint32_t g = 0; g < groups.Size(); ++g) power.push_back(groups.Candidate(g).power);
    if (!power.empty()) table_ = AliasTable(power);
}

std::optional<GroupLightSampler::ChosenGroup> PowerLightSampler::ChooseGroup(const LightQuery &query, const void *,
                                                                             Float u) const {
    const AliasTable::Sampled s = table_.Sample(u);
    return ChosenGroup{uint32_t(s.index), s.pmf, InnerNumber(query, u)};
}

Float PowerLightSampler::GroupProbability(const LightQuery &, const void *, uint32_t group) const {
    return table_.PMF(int(group));
}

std::unique_ptr<LightSampler> ByPowerUnless(std::unique_ptr<LightSampler> chosen, const LightTable &lights) {
    return chosen ? std::move(chosen) : std::make_unique<PowerLightSampler>(lights.ByComponent());
}

void PowerLightSampler::Report(nlohmann::ordered_json &json) const {
    json["bytes"] = table_.Bytes();
    GroupLightSampler::Report(json);
}

}  // namespace pbrt
