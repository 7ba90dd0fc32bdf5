#pragma once
#include <memory>

#include "ext/groups/mesh_groups.h"
#include "pbrt/lightsamplers/registry.h"

namespace ext {

/// Any sampler that selects among candidates, run on mesh groups (`"bool meshlights" true`, --mesh-lights).
class MeshLightSampler final : public LightSampler {
  public:
    MeshLightSampler(const LightTable &lights, const LightSamplerRegistry::CandidateFactory &makeInner);

    void Prepare(PrepareContext &context) override { inner_->Prepare(context); }
    void Report(nlohmann::ordered_json &report) const override;
    void Inspect(const LightQuery &query, std::vector<InspectedValue> &values) const override { inner_->Inspect(query, values); }
    std::string DescribeStructure() const override { return inner_->DescribeStructure(); }

  private:
    const void *Weigh(const LightQuery &query, LightMemory &memory) const override;
    std::optional<SampledLight> Choose(const LightQuery &query, const void *weights, Float u) const override;
    Float Probability(const LightQuery &query, const void *weights, LightId light) const override;

    MeshGroups groups_;
    std::unique_ptr<LightSampler> inner_;
};

void RegisterMeshGrouping(LightSamplerRegistry &registry);

}  // namespace ext
