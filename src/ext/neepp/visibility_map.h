#pragma once
#include "ext/neepp/light_targets.h"
#include "ext/neepp/neepp_params.h"
#include "ext/voxels/lazy_rows.h"
#include "pbrt/lightsamplers/light_sampler.h"

namespace ext {

/// Voxel-to-voxel visibility (Guo et al. 2020, as Noh, Choi and Moon 2023 describe it): how many of `samples` segments
/// between random points of two voxels are free. One byte a pair, and only for pairs whose far end holds a light;
/// towards distant and environment lights the segment leaves the scene. The pairs of a voxel are tested when the voxel
/// is first asked for; the result depends on the pair and the seed only.
class VisibilityMap {
  public:
    explicit VisibilityMap(const VisibilityMapParams &params) : params_(params) {}

    void Prepare(PrepareContext &context, const LightGroups &groups);
    bool Prepared() const { return scene_ != nullptr; }

    const VoxelGrid &Grid() const { return grid_; }
    const LightTargets &Targets() const { return targets_; }
    /// The number of free segments to each target, from 0 to Samples(). Tests them if the row is empty.
    std::span<const uint8_t> Row(uint32_t voxel) const {
        return rows_.Get(voxel, [&](std::span<uint8_t> row) { TestSegments(voxel, row); });
    }
    int Samples() const { return params_.samples; }
    /// The mean visibility of the targets of a group, weighted by their shares, from 0 to 1; 0 without targets.
    Float GroupVisibility(std::span<const uint8_t> row, uint32_t group) const;

    /// Adds times, numbers of voxels, targets and visibility rays, and bytes.
    void Report(nlohmann::ordered_json &report) const;
    std::string Describe() const;

  private:
    void TestSegments(uint32_t voxel, std::span<uint8_t> row) const;

    VisibilityMapParams params_;
    const Scene *scene_ = nullptr;
    int seed_ = 0;
    VoxelGrid grid_;
    LightTargets targets_;
    LazyRows<uint8_t> rows_;  ///< per voxel, one value a target
    double prepareSeconds_ = 0;
};

}  // namespace ext
