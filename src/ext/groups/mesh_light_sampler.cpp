#include "ext/groups/mesh_light_sampler.h"

#include <nlohmann/json.hpp>

namespace ext {

MeshLightSampler::MeshLightSampler(const LightTable &lights, const LightSamplerRegistry::CandidateFactory &makeInner)
    : groups_(lights, true), inner_(makeInner(groups_.Candidates())) {}

const void *MeshLightSampler::Weigh(const LightQuery &query, LightMemory &memory) const {
    auto *groups = memory.Make<LightDistribution>();
    *groups = inner_->Within(query, memory);
    return groups;
}

std::optional<SampledLight> MeshLightSampler::Choose(const LightQuery &query, const void *weights, Float u) const {
    std::optional<SampledLight> group = static_cast<const LightDistribution *>(weights)->Sample(u);
    if (!group) return {};
    LightId light = groups_.SampleLight(group->light.value, groups_.Size() == 1 ? u : MeshGroups::InnerNumber(u, query.p));
    return SampledLight{light, group->pmf * groups_.ShareOf(light)};
}

Float MeshLightSampler::Probability(const LightQuery &, const void *weights, LightId light) const {
    const auto *groups = static_cast<const LightDistribution *>(weights);
    return groups->PMF(LightId(groups_.GroupOf(light))) * groups_.ShareOf(light);
}

void MeshLightSampler::Report(nlohmann::ordered_json &report) const {
    inner_->Report(report);
    report["groups"] = groups_.Size();
    report["lights"] = groups_.LightCount();
}

void RegisterMeshGrouping(LightSamplerRegistry &registry) {
    registry.SetMeshGrouping([](const LightTable &lights, const LightSamplerRegistry::CandidateFactory &makeInner) {
        return std::make_unique<MeshLightSampler>(lights, makeInner);
    });
}

}  // namespace ext
