#pragma once
#include "ext/neepp/visibility_map.h"
#include "pbrt/lightsamplers/shadow_ray_gate.h"

namespace ext {

/// The second half of NEE++: a shadow ray is skipped with probability 1 - v, where v is the stored visibility between
/// the voxels of its ends, but never with a higher probability than 1 - minimum. Where nothing is stored about the far
/// end it is always traced.
class NeeppGate final : public ShadowRayGate {
  public:
    NeeppGate(const LightTable &lights, const NeeppGateParams &params)
        : params_(params), groups_(lights.Wholes()), map_(params.map) {}

    void Prepare(PrepareContext &context) override;
    Float TraceProbability(const LightQuery &query, LightId light, const Point3 &onLight) const override;
    void Report(nlohmann::ordered_json &report) const override;

    const VisibilityMap &Map() const { return map_; }

  private:
    NeeppGateParams params_;
    const LightGroups &groups_;
    VisibilityMap map_;
};

}  // namespace ext
