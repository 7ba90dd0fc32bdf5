#pragma once
#include "ext/baselines/neepp/neepp_params.h"
#include "ext/baselines/neepp/visibility_map.h"
#include "ext/voxels/voxel_light_sampler.h"

namespace ext {

/// NEE++ (Guo et al. 2020, as Noh, Choi and Moon 2023 describe it): chooses lights in proportion to the stored
/// visibility between the point's voxel and the lights' voxels. Nothing else counts, neither power nor distance.
/// Visibility below the floor counts as the floor, so every light can be chosen. Before Prepare all groups have the
/// same share.
class NeeppLightSampler final : public VoxelLightSampler {
  public:
    NeeppLightSampler(const LightTable &lights, const NeeppParams &params);

    void Prepare(PrepareContext &context) override;
    void Report(nlohmann::ordered_json &report) const override;
    void Inspect(const LightQuery &query, std::vector<InspectedValue> &values) const override;
    std::string DescribeStructure() const override;

    const VisibilityMap &Map() const { return map_; }

  private:
    /// Fills the row of the voxel if it is empty.
    std::span<const uint32_t> Cdf(const Point3 &p) const override;

    NeeppParams params_;
    VisibilityMap map_;
    LazyRows<uint32_t> cdfs_;  ///< per voxel
    bool prepared_ = false;    ///< false: one group or none, or Prepare was not called
};

}  // namespace ext
