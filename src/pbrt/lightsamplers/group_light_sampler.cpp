#include "pbrt/lightsamplers/simple_light_samplers.h"

#include <nlohmann/json.hpp>

namespace pbrt {

std::optional<SampledLight> GroupLightSampler::Choose(const LightQuery &query, const void *weights, Float u,
                                                      Point2 *uPoint) const {
    if (groups_.Size() == 0) return {};
    ChosenGroup chosen{.inner = u};
    if (choosesGroup_) {
        std::optional<ChosenGroup> group = ChooseGroup(query, weights, u);
        if (!group) return {};
        chosen = *group;
    }
    std::optional<SampledLight> light = ChooseInside(query, weights, chosen.group, chosen.inner, uPoint);
    if (!light) return {};
    return SampledLight{light->light, light->pmf * chosen.pmf, light->pmf * chosen.unoccluded, chosen.weight,
                        light->region};
}

Float GroupLightSampler::Probability(const LightQuery &query, const void *weights, LightId light) const {
    if (light.value >= groups_.LightCount()) return 0;
    const Float inside = ProbabilityInside(query, weights, light);
    if (!choosesGroup_ || !(inside > 0)) return inside;
    return inside * GroupProbability(query, weights, groups_.GroupOf(light));
}

void GroupLightSampler::Report(nlohmann::ordered_json &report) const {
    report["groups"] = groups_.Size();
    report["lights"] = groups_.LightCount();
}

GroupLightSampler::ChosenGroup GroupLightSampler::SampleUniformly(const LightQuery &query, Float u) const {
    const size_t count = groups_.Size();
    const Float pmf = 1 / Float(count);
    // In double: a float times a large count could round up to the next group.
    const auto i = size_t(double(u) * double(count));
    const auto group = uint32_t(std::min(i, count - 1));
    return {group, pmf, LightGroups::InnerNumber(u, query.p, Float(group) * pmf, pmf)};
}

GroupLightSampler::ChosenGroup GroupLightSampler::SampleCdf(std::span<const Float> cdf, const LightQuery &query,
                                                            Float u) {
    const auto group = uint32_t(std::upper_bound(cdf.begin(), cdf.end(), u) - cdf.begin());
    const Float share = CdfPMF(cdf, group);
    return {group, share, LightGroups::InnerNumber(u, query.p, cdf[group] - share, share)};
}

std::unique_ptr<LightSampler> ByPowerUnless(std::unique_ptr<LightSampler> chosen, const LightTable &lights) {
    return chosen ? std::move(chosen) : std::make_unique<PowerLightSampler>(lights.ByComponent());
}

void PowerLightSampler::Report(nlohmann::ordered_json &json) const {
    json["bytes"] = table_.Bytes();
    GroupLightSampler::Report(json);
}

}  // namespace pbrt
