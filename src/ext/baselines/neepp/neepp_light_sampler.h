#pragma once
#include "ext/baselines/neepp/neepp_params.h"
#include "ext/baselines/neepp/visibility_map.h"
#include "ext/voxels/voxel_light_sampler.h"

namespace ext {

/// NEE++ (Guo et al. 2020, as described by Noh, Choi and Moon 2023): selects lights in proportion to the stored
/// visibility between the voxels of point and light, ignoring power and distance. Visibility is clamped to the floor,
/// so every light can be selected. Before Prepare, selection is uniform.
class NeeppLightSampler final : public VoxelLightSampler {
  public:
    NeeppLightSampler(const LightTable &lights, const NeeppParams &params);

    void Prepare(PrepareContext &context) override;
    void Report(nlohmann::ordered_json &report) const override;
    void Inspect(const LightQuery &query, std::vector<InspectedValue> &values) const override;
    std::string DescribeStructure() const override;

    const VisibilityMap &Map() const { return map_; }

  private:
    std::span<const uint32_t> Cdf(const Point3 &p) const override;

    NeeppParams params_;
    VisibilityMap map_;
    LazyRows<uint32_t> cdfs_;  ///< per voxel
    bool prepared_ = false;    ///< false: at most one group, or Prepare was not called
};

}  // namespace ext
