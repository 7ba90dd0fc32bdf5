#pragma once
#include "pbrt/lightsamplers/infinite_share.h"
#include "pbrt/lightsamplers/light_bvh.h"

namespace pbrt {

/// Walks down a tree of light bounds, at each node by the importance of the two children at the query point with the
/// shading normal. Infinite lights as InfiniteShare says.
class BVHLightSampler final : public LightSampler {
  public:
    explicit BVHLightSampler(std::span<const LightCandidate> candidates);
    void Report(nlohmann::ordered_json &json) const override;

    const LightBvh &Tree() const { return tree_; }

  private:
    std::optional<SampledLight> Choose(const LightQuery &query, const void *weights, Float u) const override;
    Float Probability(const LightQuery &query, const void *weights, LightId light) const override;
    LightBvh tree_;
    InfiniteShare infinite_;
    std::vector<bool> isInfinite_;
};

}  // namespace pbrt
