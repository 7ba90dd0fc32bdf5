#pragma once
#include <vector>

#include "ext/voxels/voxel_grid.h"
#include "pbrt/lights/light_groups.h"
#include "pbrt/scene/scene.h"

namespace ext {

/// The targets of visibility tests: the voxels that hold lights (a voxel is one target, however many lights it holds),
/// the directions of distant lights, and for environments the sphere of directions in 8 x 8 parts of equal size. Also
/// which targets each group of lights covers, and by what share.
class LightTargets {
  public:
    /// Parts of the sphere along each side of its equal-area square.
    static constexpr int SkySide = 8;

    enum class Kind : uint8_t { Voxel, Direction, SkyPart };
    struct Target {
        Kind kind = Kind::Voxel;
        uint32_t index = 0;   ///< voxel or part of the sphere
        Vector3 direction{};  ///< unit, for Direction
    };
    /// The share of a group that falls into a target: by power, which is by area where a mesh emits evenly.
    struct Share {
        uint32_t target = 0;
        Float weight = 0;
    };

    LightTargets() = default;
    LightTargets(const Scene &scene, const VoxelGrid &grid, const LightGroups &groups);

    size_t Size() const { return targets_.size(); }
    const Target &operator[](size_t i) const { return targets_[i]; }
    /// The targets of a group; their weights sum to 1. Empty for groups without power and for a sky of one colour,
    /// which paths do not sample.
    std::span<const Share> SharesOf(uint32_t group) const {
        return {shares_.data() + first_[group], shares_.data() + first_[group + 1]};
    }

    /// The part of the sphere that holds the unit vector w.
    static uint32_t SkyPartOf(const Vector3 &w);
    /// A unit vector in a part of the sphere; u in [0, 1)^2.
    static Vector3 DirectionIn(uint32_t skyPart, const Point2 &u);
    size_t Bytes() const;

  private:
    std::vector<Target> targets_;
    std::vector<uint32_t> first_{0};  ///< per group, into shares_; one more at the end
    std::vector<Share> shares_;
};

}  // namespace ext
