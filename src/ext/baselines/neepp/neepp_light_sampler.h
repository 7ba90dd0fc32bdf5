#pragma once
#include "ext/baselines/neepp/visibility_map.h"
#include "ext/voxels/voxel_light_sampler.h"
#include "pbrt/core/describe.h"

namespace ext {

struct NeeppParams {
    int voxels = 16;
    int samples = 16;
    Float floor = 0.02f;
    bool meshlights = true;

    void Describe(auto &&v) {
        v("voxels", voxels, Range<int>{1, 128}, "voxels along the longest axis of the scene");
        v("samples", samples, Range<int>{1, 255}, "segments tested for a pair of voxels");
        v("floor", floor, Range<Float>{1e-4f, 1.f}, "least visibility assumed of any light");
        v("meshlights", meshlights, "an emissive mesh is one light for selection");
    }
};

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
    std::vector<double> Weights(uint32_t voxel) const override;

    NeeppParams params_;
    VisibilityMap map_;
};

}  // namespace ext
