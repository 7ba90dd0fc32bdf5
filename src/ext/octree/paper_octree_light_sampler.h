#pragma once
#include <memory>

#include "ext/octree/light_octree.h"
#include "ext/octree/octree_params.h"
#include "pbrt/lightsamplers/group_light_sampler.h"

namespace ext {

/// "Enhanced Direct Lighting Using Visibility-Aware Light Sampling" (Noh, Choi, Moon 2023), section 4. A prepass traces
/// short camera paths and, at every vertex, one shadow ray per light: g = Le G V / p (Eq. 5). An octree over the
/// vertices stores the mean of g per leaf and light; selection is proportional to this mean.
///
/// Departures where the paper is silent:
/// - P(l | x) = (1 - floor) leaf(x, l) + floor * importance(x, l). Without the floor, lights that no sample of a leaf
///   reached would have probability 0 (bias). importance is stock pbrt-v4's unoccluded estimate at x: the exhaustive
///   sampler up to 64 groups, the light BVH above.
/// - A cell without vertices or without visible lights uses the nearest ancestor's distribution.
class PaperOctreeLightSampler final : public GroupLightSampler {
  public:
    PaperOctreeLightSampler(const LightTable &lights, const OctreeParams &params);

    void Prepare(PrepareContext &context) override;
    bool SavesLearned() const override { return true; }
    void SaveLearned(StateWriter &writer, bool withLearning) const override;
    void Report(nlohmann::ordered_json &report) const override;
    /// Leaf, its number of records and its depth.
    void Inspect(const LightQuery &query, std::vector<InspectedValue> &values) const override;
    std::string DescribeStructure() const override;

    const LightOctree &Tree() const { return tree_; }

  private:
    void LoadLearned(StateReader &reader);
    const void *WeighGroups(const LightQuery &query, LightMemory &memory) const override;
    std::optional<ChosenGroup> ChooseGroup(const LightQuery &query, const void *weights, Float u) const override;
    Float GroupProbability(const LightQuery &query, const void *weights, uint32_t group) const override;
    /// Distributions for a query: CDF of its leaf (null: not learned) and weights of unoccluded_.
    struct Weights {
        const Float *cdf = nullptr;
        const void *unoccluded = nullptr;
    };

    OctreeParams params_;
    Float floor_;
    std::unique_ptr<GroupLightSampler> unoccluded_;  ///< over groups
    LightOctree tree_;
    std::vector<uint32_t> recordsPerNode_;  ///< for Inspect and DescribeStructure only
    bool learned_ = false;  ///< false: at most one group, or Prepare was not called; only unoccluded_ is used
    size_t vertices_ = 0;
    double prepassSeconds_ = 0, buildSeconds_ = 0;
};

}  // namespace ext
