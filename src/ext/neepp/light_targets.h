#pragma once
#include <vector>

#include "pbrt/lights/light_groups.h"
#include "ext/voxels/voxel_grid.h"
#include "pbrt/scene/scene.h"

namespace ext {

/// The far ends of visibility: the voxels that hold lights, each once whatever number of lights it holds; the
/// directions of distant lights; and for environments the sphere of directions in 8 x 8 parts of equal size. And which
/// of them each group of lights covers, by what share.
class LightTargets {
  public:
    static constexpr uint32_t None = 0xffffffffu;
    /// Parts of the sphere along each side of its equal-area square.
    static constexpr int SkySide = 8;

    enum class Kind : uint8_t { Voxel, Direction, SkyPart };
    struct Target {
        Kind kind = Kind::Voxel;
        uint32_t index = 0;   ///< voxel or part of the sphere
        Vector3 direction{};  ///< unit, for Direction
    };
    /// Part of a group's lights: by power, which is by area where a mesh emits evenly.
    struct Share {
        uint32_t target = 0;
        Float weight = 0;
    };

    LightTargets() = default;
    LightTargets(const Scene &scene, const VoxelGrid &grid, const LightGroups &groups);

    size_t Size() const { return targets_.size(); }
    const Target &operator[](size_t i) const { return targets_[i]; }
    /// Weights sum to 1; none for groups without power, and for a sky of one colour, which paths do not sample.
    std::span<const Share> SharesOf(uint32_t group) const {
        return {shares_.data() + first_[group], shares_.data() + first_[group + 1]};
    }
    /// Where the segment from `from` to the point `onLight` of a light ends; None if the light was not expected there.
    uint32_t Find(const VoxelGrid &grid, LightId light, const Point3 &from, const Point3 &onLight) const;

    /// Part of the sphere that holds the unit vector w, and a direction in a part.
    static uint32_t SkyPartOf(const Vector3 &w);
    static Vector3 DirectionIn(uint32_t skyPart, const Point2 &u);
    size_t Bytes() const;

  private:
    uint32_t VoxelTarget(uint32_t voxel);
    uint32_t SkyTarget(uint32_t part);

    std::vector<Target> targets_;
    std::vector<uint32_t> first_{0};  ///< per group, into shares_; one more at the end
    std::vector<Share> shares_;
    std::vector<uint32_t> ofVoxel_, ofSkyPart_;  ///< target or None
    std::vector<uint32_t> ofLight_;              ///< distant lights: target; others None
    std::vector<LightKind> kindOf_;              ///< per light
};

}  // namespace ext
