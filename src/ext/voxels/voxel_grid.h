#pragma once
#include <cstdint>
#include <string>

#include "pbrt/math/bounds.h"

namespace ext {
using namespace pbrt;

/// Regular grid over a box with nearly cubic voxels. Look-up is index arithmetic.
class VoxelGrid {
  public:
    VoxelGrid() = default;
    /// `voxels` along the longest axis, in proportion along the others. An empty box gives one voxel of zero extent at
    /// the origin.
    VoxelGrid(const Bounds3 &bounds, int voxels);

    /// Points outside are clamped to the grid; NaN maps to the first voxel.
    uint32_t Index(const Point3 &p) const {
        Vector3 q = (p - low_) * scale_;
        auto x = Clamped(q.x, resolution_.x), y = Clamped(q.y, resolution_.y), z = Clamped(q.z, resolution_.z);
        return x + uint32_t(resolution_.x) * (y + uint32_t(resolution_.y) * z);
    }
    size_t Size() const { return size_t(resolution_.x) * size_t(resolution_.y) * size_t(resolution_.z); }
    const glm::ivec3 &Resolution() const { return resolution_; }
    const Vector3 &VoxelSize() const { return size_; }
    /// Point of a voxel; u in [0, 1]^3.
    Point3 PointIn(uint32_t index, const Vector3 &u) const { return low_ + (Corner(index) + u) * size_; }
    /// Voxels with a face on the grid's border: an estimate of the number of voxels with surfaces.
    size_t BorderSize() const;
    std::string Describe() const;  ///< a line with resolution and voxel size

  private:
    static uint32_t Clamped(Float q, int resolution) {
        return uint32_t(std::max(Float(0), std::min(q, Float(resolution - 1))));
    }
    Vector3 Corner(uint32_t index) const {
        auto x = uint32_t(resolution_.x), y = uint32_t(resolution_.y);
        return Vector3(glm::uvec3(index % x, index / x % y, index / x / y));
    }

    Point3 low_{0, 0, 0};
    Vector3 scale_{0, 0, 0};  ///< voxels per unit length; 0 along an axis without extent
    Vector3 size_{0, 0, 0};
    glm::ivec3 resolution_{1, 1, 1};
};

}  // namespace ext
