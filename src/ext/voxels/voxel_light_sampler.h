#pragma once
#include "ext/voxels/fixed_cdf.h"
#include "pbrt/lightsamplers/group_light_sampler.h"

namespace ext {

/// Group light samplers with a distribution over the groups per voxel.
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
    /// Distribution of the voxel that contains p, in fixed point (BuildFixedCdf). Its address is stable until the next
    /// Prepare. Empty before Prepare: uniform.
    virtual std::span<const uint32_t> Cdf(const Point3 &p) const = 0;

  private:
    std::span<const uint32_t> Weighed(const void *weights) const {
        return {static_cast<const uint32_t *>(weights), groups_.Size()};
    }
};

}  // namespace ext
