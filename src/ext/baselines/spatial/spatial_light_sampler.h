#pragma once
#include "ext/voxels/voxel_light_sampler.h"
#include "pbrt/core/describe.h"

namespace ext {

struct SpatialParams {
    int voxels = 64;
    int samples = 128;
    Float floor = 0.001f;
    bool meshlights = true;

    void Describe(auto &&v) {
        v("voxels", voxels, Range<int>{1, 256}, "voxels along the longest axis of the scene");
        v("samples", samples, Range<int>{1, 1 << 16}, "points in a voxel, each with one light sample of every light");
        v("floor", floor, Range<Float>{1e-6f, 1.f},
          "minimum contribution of a light, as a fraction of the lights' mean");
        v("meshlights", meshlights, "an emissive mesh is one light for selection");
    }
};

/// Selects lights in proportion to their unoccluded contribution to a voxel: Eq. 3 of "Enhanced Direct Lighting Using
/// Visibility-Aware Light Sampling" (Noh, Choi, Moon 2023), Le G / p over low-discrepancy points of the voxel. The
/// points lie in space, so G has the light's cosine and the distance but no receiver cosine (as in pbrt-v3).
///
/// A voxel's distribution depends on voxel and seed only.
class SpatialLightSampler final : public VoxelLightSampler {
  public:
    SpatialLightSampler(const LightTable &lights, const SpatialParams &params);

    void Prepare(PrepareContext &context) override;
    void Report(nlohmann::ordered_json &report) const override;
    void Inspect(const LightQuery &query, std::vector<InspectedValue> &values) const override;
    std::string DescribeStructure() const override;

    const VoxelGrid &Grid() const { return grid_; }
    /// Eq. 3 for every group, excluding the floor.
    std::vector<double> UnshadowedContributions(uint32_t voxel) const;

  private:
    /// Low-discrepancy point in the voxel, with the uniform numbers of its light sample; all in [0, 1).
    struct VoxelPoint {
        Vector3 place{};
        Float uMember = 0;
        Point2 uLight{};
    };
    std::vector<double> Weights(uint32_t voxel) const override;

    const LightTable &lights_;
    SpatialParams params_;
    std::vector<VoxelPoint> points_;
};

}  // namespace ext
