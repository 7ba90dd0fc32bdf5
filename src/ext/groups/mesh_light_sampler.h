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
    std::optional<SampledLight> Sample(const LightQuery &query, Float u) const override;
    Float PMF(const LightQuery &query, LightId light) const override;
    void Report(nlohmann::ordered_json &report) const override;
    void Inspect(const LightQuery &query, std::vector<InspectedValue> &values) const override { inner_->Inspect(query, values); }
    std::string DescribeStructure() const override { return inner_->DescribeStructure(); }

  private:
    MeshGroups groups_;
    std::unique_ptr<LightSampler> inner_;
};

void RegisterMeshGrouping(LightSamplerRegistry &registry);

}  // namespace ext
