#pragma once
#include "ext/baselines/neepp/light_targets.h"
#include "ext/voxels/lazy_rows.h"
#include "pbrt/lightsamplers/light_sampler.h"

namespace ext {

/// Voxel-to-voxel visibility (Guo et al. 2020, as described by Noh, Choi and Moon 2023): how many of `samples` segments
/// between random points of two voxels are unoccluded. One byte per pair, only for pairs whose far end holds a light;
/// towards distant and environment lights the segment leaves the scene. Pairs are tested on first use of a voxel; the
/// result depends on pair and seed only.
class VisibilityMap {
  public:
    /// `voxels` along the longest scene axis; `samples` segments per pair, at most 255.
    VisibilityMap(int voxels, int samples) : voxels_(voxels), samples_(samples) {}

    void Prepare(PrepareContext &context, const LightGroups &groups);

    const VoxelGrid &Grid() const { return grid_; }
    const LightTargets &Targets() const { return targets_; }
    /// Unoccluded segments to each target, 0 to `samples`. Tested on first use.
    std::span<const uint8_t> Row(uint32_t voxel) const {
        return rows_.Get(voxel, [&](std::span<uint8_t> row) { TestSegments(voxel, row); });
    }
    /// Mean visibility of a group's targets, weighted by share, in [0, 1]; 0 without targets.
    Float GroupVisibility(std::span<const uint8_t> row, uint32_t group) const;

    /// Adds times, memory (bytes), and the numbers of voxels, targets and visibility rays.
    void Report(nlohmann::ordered_json &report) const;
    std::string Describe() const;

  private:
    void TestSegments(uint32_t voxel, std::span<uint8_t> row) const;

    int voxels_, samples_;
    const Scene *scene_ = nullptr;
    int seed_ = 0;
    VoxelGrid grid_;
    LightTargets targets_;
    LazyRows<uint8_t> rows_;  ///< per voxel, one value per target
    double prepareSeconds_ = 0;
};

}  // namespace ext
