#pragma once
#include <vector>

#include "ext/voxels/voxel_grid.h"
#include "pbrt/lights/light_groups.h"
#include "pbrt/scene/scene.h"

namespace ext {

/// Targets of visibility tests: voxels with lights (one target per voxel), directions of distant lights, and an 8 x 8
/// equal-area division of the sphere for environment lights. Also stores each light group's targets and their shares.
class LightTargets {
  public:
    /// Cells per side of the sphere's equal-area square.
    static constexpr int SkySide = 8;

    enum class Kind : uint8_t { Voxel, Direction, SkyPart };
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
    LightTargets(const Scene &scene, const VoxelGrid &grid, const LightGroups &groups);

    size_t Size() const { return targets_.size(); }
    const Target &operator[](size_t i) const { return targets_[i]; }
    /// Targets of a group; weights sum to 1. Empty for groups without power and for uniform environment lights, which
    /// paths do not sample.
    std::span<const Share> SharesOf(uint32_t group) const {
        return {shares_.data() + first_[group], shares_.data() + first_[group + 1]};
    }

    /// Cell of the sphere that contains the unit vector w.
    static uint32_t SkyPartOf(const Vector3 &w);
    /// Unit vector in a cell of the sphere; u in [0, 1)^2.
    static Vector3 DirectionIn(uint32_t skyPart, const Point2 &u);
    size_t Bytes() const;

  private:
    std::vector<Target> targets_;
    std::vector<uint32_t> first_{0};  ///< per group, index into shares_; one more entry at the end
    std::vector<Share> shares_;
};

}  // namespace ext
