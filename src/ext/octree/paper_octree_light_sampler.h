#pragma once
#include <memory>

#include "ext/octree/light_octree.h"
#include "ext/octree/octree_params.h"
#include "pbrt/lightsamplers/group_light_sampler.h"

namespace ext {

/// "Enhanced Direct Lighting Using Visibility-Aware Light Sampling" (Noh, Choi, Moon 2023), section 4: a prepass traces
/// short camera paths; at every vertex one shadow ray to each light gives g = Le G V / p (Eq. 5); an octree over the
/// vertices stores the mean of g per leaf and light; lights are chosen in proportion to this mean.
///
/// Departures, both where the paper is silent:
/// - P(l | x) = (1 - floor) leaf(x, l) + floor * importance(x, l): without the second term a light that no sample of
///   a leaf saw would have probability 0, and the image would be biased. importance is the unoccluded estimate of stock
///   pbrt-v4's samplers at the point itself: the exhaustive sampler for up to 64 groups, the light BVH for more.
/// - A cell without vertices, or whose vertices saw no light, uses the nearest ancestor's distribution.
class PaperOctreeLightSampler final : public GroupLightSampler {
  public:
    PaperOctreeLightSampler(const LightTable &lights, const OctreeParams &params);
    ~PaperOctreeLightSampler() override;

    void Prepare(PrepareContext &context) override;
    bool SavesLearned() const override { return true; }
    void SaveLearned(StateWriter &writer, bool goesOn) const override;
    void Report(nlohmann::ordered_json &report) const override;
    /// The leaf, the number of its records and its depth.
    void Inspect(const LightQuery &query, std::vector<InspectedValue> &values) const override;
    std::string DescribeStructure() const override;

    const LightOctree &Tree() const { return tree_; }

  private:
    void LoadLearned(StateReader &reader);
    const void *WeighGroups(const LightQuery &query, LightMemory &memory) const override;
    std::optional<ChosenGroup> ChooseGroup(const LightQuery &query, const void *weights, Float u) const override;
    Float GroupProbability(const LightQuery &query, const void *weights, uint32_t group) const override;
    /// The distributions for a query: that of its leaf (null: nothing was learned) and the weights of unoccluded_.
    struct Weights {
        const Float *cdf = nullptr;
        const void *unoccluded = nullptr;
    };

    OctreeParams params_;
    Float floor_;
    std::unique_ptr<GroupLightSampler> unoccluded_;  ///< over groups
    LightOctree tree_;
    std::vector<uint32_t> recordsPerNode_;  ///< for Inspect and DescribeStructure only
    bool learned_ = false;                  ///< false: one group or none, or Prepare was not called: unoccluded_ alone
    size_t vertices_ = 0;
    double prepassSeconds_ = 0, buildSeconds_ = 0;
};

}  // namespace ext
