#pragma once
#include <cstdint>
#include <span>

#include "ext/voxels/lazy_rows.h"
#include "ext/voxels/voxel_grid.h"
#include "pbrt/lightsamplers/group_light_sampler.h"
#include "pbrt/math/rng.h"

namespace ext {
using namespace pbrt;

// Discrete distribution with 4 bytes per entry: its start in the CDF, in units of 2^-32, from 0; the last entry ends at
// 1. Differences are exact: probabilities sum to 1, and small ones survive beside large ones, unlike with float running
// sums.

/// Builds a distribution proportional to the weights (>= 0, finite; uniform if all are 0). Every entry gets at least
/// 2^-32.
void BuildFixedCdf(std::span<const double> weights, std::span<uint32_t> begins);

inline Float FixedCdfPMF(std::span<const uint32_t> begins, uint32_t index) {
    uint64_t end = index + 1 < begins.size() ? begins[index + 1] : uint64_t(1) << 32;
    return Float(end - begins[index]) * 0x1p-32f;
}

inline Float FixedCdfBegin(std::span<const uint32_t> begins, uint32_t index) { return Float(begins[index]) * 0x1p-32f; }

/// Entry for a uniform number u. A float near 1 has 24 bits, too few for narrow entries, so lower bits come from a hash
/// of u and the query point `p`.
uint32_t SampleFixedCdf(std::span<const uint32_t> begins, Float u, const Point3 &p);

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
