#pragma once
#include "ext/voxels/fixed_cdf.h"
#include "ext/voxels/lazy_rows.h"
#include "ext/voxels/voxel_grid.h"
#include "pbrt/lightsamplers/group_light_sampler.h"

namespace ext {

/// Group light samplers with a distribution over the groups per voxel, created on first use. Before Prepare, selection
/// is uniform.
class VoxelLightSampler : public GroupLightSampler {
  public:
    const void *WeighGroups(const LightQuery &query, LightMemory &) const final { return Cdf(query.p).data(); }
    std::optional<ChosenGroup> ChooseGroup(const LightQuery &query, const void *weights, Float u) const final {
        if (!weights) return SampleUniformly(query, u);
        const std::span<const uint32_t> cdf = Weighed(weights);
        const uint32_t group = SampleFixedCdf(cdf, u, query.p);
        const Float pmf = FixedCdfPMF(cdf, group);
        return ChosenGroup{group, pmf, LightGroups::InnerNumber(u, query.p, FixedCdfBegin(cdf, group), pmf)};
    }
    Float GroupProbability(const LightQuery &, const void *weights, uint32_t group) const final {
        return weights ? FixedCdfPMF(Weighed(weights), group) : 1 / Float(groups_.Size());
    }

  protected:
    using GroupLightSampler::GroupLightSampler;
    /// For Prepare.
    void PrepareVoxels(const VoxelGrid &grid) {
        grid_ = grid;
        cdfs_.Reset(grid.Size(), groups_.Size());
    }
    bool IsPrepared() const { return cdfs_.Size() > 0; }
    /// Weights of the groups in a voxel (>= 0, finite), in proportion to which they are selected.
    virtual std::vector<double> Weights(uint32_t voxel) const = 0;
    /// Distribution of the voxel that contains p, in fixed point (BuildFixedCdf). Its address is stable until the next
    /// Prepare. Empty before Prepare: uniform.
    std::span<const uint32_t> Cdf(const Point3 &p) const {
        if (!IsPrepared()) return {};
        const uint32_t voxel = grid_.Index(p);
        return cdfs_.Get(voxel, [&](std::span<uint32_t> begins) { BuildFixedCdf(Weights(voxel), begins); });
    }

    VoxelGrid grid_;
    LazyRows<uint32_t> cdfs_;  ///< per voxel

  private:
    std::span<const uint32_t> Weighed(const void *weights) const {
        return {static_cast<const uint32_t *>(weights), groups_.Size()};
    }
};

}  // namespace ext
