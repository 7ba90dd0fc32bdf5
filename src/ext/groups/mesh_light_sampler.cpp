#include "ext/groups/mesh_light_sampler.h"

namespace ext {

MeshLightSampler::MeshLightSampler(const LightTable &lights, const LightSamplerRegistry::CandidateFactory &makeInner)
    : groups_(lights, true), inner_(makeInner(groups_.Candidates())) {}

std::optional<SampledLight> MeshLightSampler::Sample(const LightQuery &query, Float u) const {
    std::optional<SampledLight> group = inner_->Sample(query, u);
    if (!group) return {};
    LightId light = groups_.SampleLight(group->light.value, groups_.Size() == 1 ? u : MeshGroups::InnerNumber(u, query.p));
    return SampledLight{light, group->pmf * groups_.ShareOf(light)};
}

Float MeshLightSampler::PMF(const LightQuery &query, LightId light) const {
    return inner_->PMF(query, LightId(groups_.GroupOf(light))) * groups_.ShareOf(light);
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
