#include "pbrt/lightsamplers/simple_light_samplers.h"

#include <nlohmann/json.hpp>

namespace pbrt {

UniformLightSampler::UniformLightSampler(std::span<const LightCandidate> candidates)
    : count_(static_cast<uint32_t>(candidates.size())), pmf_(count_ > 0 ? 1 / static_cast<Float>(count_) : 0) {}

std::optional<SampledLight> UniformLightSampler::Choose(const LightQuery &, const void *, Float u) const {
    if (count_ == 0) return {};
    // In double: a float times a large count could round up to the next light.
    auto i = static_cast<uint32_t>(static_cast<double>(u) * static_cast<double>(count_));
    return SampledLight{LightId(std::min(i, count_ - 1)), pmf_};
}

Float UniformLightSampler::Probability(const LightQuery &, const void *, LightId light) const { return light.value < count_ ? pmf_ : 0; }

PowerLightSampler::PowerLightSampler(std::span<const LightCandidate> candidates) {
    std::vector<Float> power;
    power.reserve(candidates.size());
    for (const LightCandidate &c : candidates) power.push_back(c.power);
    if (!power.empty()) table_ = AliasTable(power);
}

std::optional<SampledLight> PowerLightSampler::Choose(const LightQuery &, const void *, Float u) const {
    if (table_.Size() == 0) return {};
    AliasTable::Sampled s = table_.Sample(u);
    return SampledLight{LightId(static_cast<uint32_t>(s.index)), s.pmf};
}

Float PowerLightSampler::Probability(const LightQuery &, const void *, LightId light) const {
    return light.value < static_cast<uint32_t>(table_.Size()) ? table_.PMF(static_cast<int>(light.value)) : 0;
}

void PowerLightSampler::Report(nlohmann::ordered_json &json) const { json["bytes"] = table_.Bytes(); }

}  // namespace pbrt
