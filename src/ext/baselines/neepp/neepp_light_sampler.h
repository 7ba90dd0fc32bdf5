#pragma once
#include <vector>

#include "ext/voxels/voxel_light_sampler.h"
#include "pbrt/core/describe.h"
#include "pbrt/lights/light_table.h"
#include "pbrt/lightsamplers/light_sampler.h"

namespace ext {

/// Targets of visibility tests: voxels with lights (one target per voxel), directions of distant lights, and an 8 x 8
/// equal-area division of the sphere for environment lights. Also stores each light group's targets and their shares.
class LightTargets {
  public:
    static constexpr int kEnvironmentSide = 8;  ///< cells per side of the sphere's equal-area square

    enum class Kind : uint8_t { Voxel, Direction, EnvironmentCell };
    struct Target {
        Kind kind = Kind::Voxel;
        uint32_t index = 0;   ///< voxel or cell of the sphere
        Vector3 direction{};  ///< unit; for Direction
    };
    /// Share of a group in a target: by power, equal to area for uniformly emitting meshes.
    struct Share {
        uint32_t target = 0;
        Float weight = 0;
    };

    LightTargets() = default;
    /// Targets of the scene's lights. Environment lights and large emitters are divided by samples of them.
    static LightTargets Of(const Scene &scene, const VoxelGrid &grid, const LightGroups &groups);

    size_t Size() const { return targets_.size(); }
    const Target &operator[](size_t i) const { return targets_[i]; }
    /// Targets of a group; weights sum to 1. Empty for groups without power and for uniform environment lights, which
    /// paths do not sample.
    std::span<const Share> SharesOf(uint32_t group) const {
        return {shares_.data() + first_[group], shares_.data() + first_[group + 1]};
    }

    static uint32_t EnvironmentCellOf(const Vector3 &w);         ///< cell of the sphere that contains the unit vector w
    static Vector3 DirectionIn(uint32_t cell, const Point2 &u);  ///< unit vector in a cell of the sphere; u in [0, 1)^2
    size_t Bytes() const;

  private:
    class Builder;
    std::vector<Target> targets_;
    std::vector<uint32_t> first_{0};  ///< per group, index into shares_; one more entry at the end
    std::vector<Share> shares_;
};

struct NeeppParams {
    int voxels = 16;
    int samples = 16;
    Float floor = 0.02f;
    bool meshlights = true;

    void Describe(auto &&v) {
        v("voxels", voxels, Range<int>{1, 128}, "voxels along the longest axis of the scene");
        v("samples", samples, Range<int>{1, 255}, "segments tested for a pair of voxels");
        v("floor", floor, Range<Float>{1e-4f, 1.f}, "minimum visibility of a light");
        v("meshlights", meshlights, "an emissive mesh is one light for selection");
    }
};

/// NEE++ (Guo et al. 2020, as described by Noh, Choi and Moon 2023): selects lights in proportion to the stored
/// visibility between the voxels of point and light, ignoring power and distance. Visibility is clamped to the floor,
/// so every light can be selected. Before Prepare, selection is uniform.
///
/// Stored is how many of `samples` segments between random points of two voxels are unoccluded. One byte per pair, only
/// for pairs whose far end holds a light; towards distant and environment lights the segment leaves the scene. Pairs
/// are tested on first use of a voxel; the result depends on pair and seed only.
class NeeppLightSampler final : public VoxelLightSampler {
  public:
    NeeppLightSampler(const LightTable &lights, const NeeppParams &params);

    void Prepare(PrepareContext &context) override;
    void Report(nlohmann::ordered_json &report) const override;
    void Inspect(const LightQuery &query, std::vector<InspectedValue> &values) const override;
    std::string DescribeStructure() const override;

    const VoxelGrid &Grid() const { return grid_; }
    const LightTargets &Targets() const { return targets_; }
    /// Unoccluded segments to each target, 0 to `samples`. Tested on first use.
    std::span<const uint8_t> Row(uint32_t voxel) const {
        return rows_.Get(voxel, [&](std::span<uint8_t> row) { TestSegments(voxel, row); });
    }
    /// Mean visibility of a group's targets, weighted by share, in [0, 1]; 0 without targets.
    Float GroupVisibility(std::span<const uint8_t> row, uint32_t group) const;

  private:
    std::vector<double> Weights(uint32_t voxel) const override;
    void TestSegments(uint32_t voxel, std::span<uint8_t> row) const;

    NeeppParams params_;
    const Scene *scene_ = nullptr;
    LightTargets targets_;
    LazyRows<uint8_t> rows_;  ///< per voxel, one value per target
};

}  // namespace ext
