#pragma once
#include "pbrt/math/vec.h"

namespace pbrt {

/// Evenly spaced voxels in a box, x fastest. A voxel's value stands at its centre; between the centres values are
/// interpolated linearly along each axis, and outside the box all voxels are 0, so that values fade in the outer half
/// of the outermost voxels. This is how stock pbrt-v4 reads its grids.
///
/// Places are given in the coordinates of a MajorantGrid over the same box. What the voxels hold is up to the callers,
/// who pass a function from the index of a voxel to its value.
class Voxels {
  public:
    Voxels(const glm::ivec3 &count, const glm::ivec3 &gridResolution)
        : count_(count), perCell_(Vector3(count) / Vector3(gridResolution)) {}

    const glm::ivec3 &Count() const { return count_; }
    size_t Size() const {
        return static_cast<size_t>(count_.x) * static_cast<size_t>(count_.y) * static_cast<size_t>(count_.z);
    }

    /// The interpolated value at a place.
    template <class ValueOf>
    auto Interpolate(const Point3 &p, ValueOf &&valueOf) const {
        const Vector3 v = ToVoxels(p), low = glm::floor(v), w = v - low;
        const glm::ivec3 first(low);
        using Value = decltype(valueOf(size_t(0)));
        Value sum{};
        for (int z = 0; z < 2; ++z)
            for (int y = 0; y < 2; ++y)
                for (int x = 0; x < 2; ++x) {
                    const glm::ivec3 at = first + glm::ivec3(x, y, z);
                    if (!Has(at)) continue;
                    const Float weight = (x ? w.x : 1 - w.x) * (y ? w.y : 1 - w.y) * (z ? w.z : 1 - w.z);
                    if (weight > 0) sum += valueOf(IndexOf(at)) * weight;
                }
        return sum;
    }
    /// The largest value of all voxels that reach into a cell of the grid; at least 0.
    template <class ValueOf>
    Float MaxIn(const glm::ivec3 &cell, ValueOf &&valueOf) const {
        const glm::ivec3 low = glm::max(glm::ivec3(glm::floor(ToVoxels(Point3(cell)))), glm::ivec3(0));
        const glm::ivec3 high = glm::min(glm::ivec3(glm::ceil(ToVoxels(Point3(cell + 1)))), count_ - 1);
        Float max = 0;
        for (int z = low.z; z <= high.z; ++z)
            for (int y = low.y; y <= high.y; ++y)
                for (int x = low.x; x <= high.x; ++x) max = std::max(max, valueOf(IndexOf({x, y, z})));
        return max;
    }

  private:
    /// In units of voxels, so that the centre of voxel i is at i. The fused operation rounds in the same way wherever
    /// it is inlined; it does not decrease with p, so a cell's voxels are those between the ends of the cell.
    Vector3 ToVoxels(const Point3 &p) const {
        return {std::fma(p.x, perCell_.x, Float(-0.5)), std::fma(p.y, perCell_.y, Float(-0.5)),
                std::fma(p.z, perCell_.z, Float(-0.5))};
    }
    bool Has(const glm::ivec3 &v) const {
        return v.x >= 0 && v.y >= 0 && v.z >= 0 && v.x < count_.x && v.y < count_.y && v.z < count_.z;
    }
    size_t IndexOf(const glm::ivec3 &v) const {
        return (static_cast<size_t>(v.z) * static_cast<size_t>(count_.y) + static_cast<size_t>(v.y)) *
                   static_cast<size_t>(count_.x) +
               static_cast<size_t>(v.x);
    }
    glm::ivec3 count_;
    Vector3 perCell_;
};

}  // namespace pbrt
