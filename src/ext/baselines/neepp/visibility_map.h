#pragma once
#include "ext/baselines/neepp/light_targets.h"
#include "ext/voxels/lazy_rows.h"
#include "pbrt/lightsamplers/light_sampler.h"

namespace ext {

/// Voxel-to-voxel visibility (Guo et al. 2020, as Noh, Choi and Moon 2023 describe it): how many of `samples` segments
/// between random points of two voxels are free. One byte a pair, and only for pairs whose far end holds a light;
/// towards distant and environment lights the segment leaves the scene. The pairs of a voxel are tested when the voxel
/// is first asked for; the result depends on the pair and the seed only.
class VisibilityMap {
  public:
    /// `voxels` along the longest axis of the scene; `samples` segments for a pair of voxels, at most 255.
    VisibilityMap(int voxels, int samples) : voxels_(voxels), samples_(samples) {}

    void Prepare(PrepareContext &context, const LightGroups &groups);

    const VoxelGrid &Grid() const { return grid_; }
    const LightTargets &Targets() const { return targets_; }
    /// The number of free segments to each target, from 0 to `samples`. Tests them if the row is empty.
    std::span<const uint8_t> Row(uint32_t voxel) const {
        return rows_.Get(voxel, [&](std::span<uint8_t> row) { TestSegments(voxel, row); });
    }
    /// The mean visibility of the targets of a group, weighted by their shares, from 0 to 1; 0 without targets.
    Float GroupVisibility(std::span<const uint8_t> row, uint32_t group) const;

    /// Adds times, numbers of voxels, targets and visibility rays, and bytes.
    void Report(nlohmann::ordered_json &report) const;
    std::string Describe() const;

  private:
    void TestSegments(uint32_t voxel, std::span<uint8_t> row) const;

    int voxels_, samples_;
    const Scene *scene_ = nullptr;
    int seed_ = 0;
    VoxelGrid grid_;
    LightTargets targets_;
    LazyRows<uint8_t> rows_;  ///< per voxel, one value a target
    double prepareSeconds_ = 0;
};

}  // namespace ext
