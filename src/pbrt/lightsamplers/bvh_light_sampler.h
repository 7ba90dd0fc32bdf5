#pragma once
#include "pbrt/lightsamplers/group_light_sampler.h"
#include "pbrt/lightsamplers/light_bvh.h"

namespace pbrt {

/// Traverses a light BVH, selecting children by their importance at the query point with the shading normal. Infinite
/// lights: see InfiniteShare.
class BVHLightSampler final : public GroupLightSampler {
  public:
    explicit BVHLightSampler(const LightGroups &groups);
    std::optional<ChosenGroup> ChooseGroup(const LightQuery &query, const void *weights, Float u) const override;
    Float GroupProbability(const LightQuery &query, const void *weights, uint32_t group) const override;
    void Report(nlohmann::ordered_json &json) const override;

    const LightBvh &Tree() const { return tree_; }

  private:
    /// False if the tree holds a single light whose importance at the query point is 0.
    bool Reaches(const LightQuery &query) const;

    LightBvh tree_;
    InfiniteShare infinite_;
    std::vector<bool> isInfinite_;
};

}  // namespace pbrt
