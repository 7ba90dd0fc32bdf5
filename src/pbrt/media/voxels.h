#pragma once
#include "pbrt/math/vec.h"

namespace pbrt {

/// Regular voxels in a box, x fastest. Values are at voxel centres, interpolated trilinearly. As in stock pbrt-v4,
/// voxels outside the box are 0, so values fade in the outer half of the outermost voxels.
///
/// Points are in the coordinates of a MajorantGrid over the same box. Callers pass a function from voxel index to
/// value.
class Voxels {
  public:
    Voxels(const glm::ivec3 &count, const glm::ivec3 &gridResolution)
        : count_(count), perCell_(Vector3(count) / Vector3(gridResolution)) {}

    const glm::ivec3 &Count() const { return count_; }
    size_t Size() const { return size_t(1) * count_.x * count_.y * count_.z; }

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
    /// Largest value of all voxels that influence a grid cell; at least 0.
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
    /// Voxel units, centre of voxel i at i. The fused operation rounds identically wherever it is inlined, and is
    /// monotonic in p, so a cell's voxels are those between its ends.
    Vector3 ToVoxels(const Point3 &p) const {
        return {std::fma(p.x, perCell_.x, Float(-0.5)), std::fma(p.y, perCell_.y, Float(-0.5)),
                std::fma(p.z, perCell_.z, Float(-0.5))};
    }
    bool Has(const glm::ivec3 &v) const {
        return v.x >= 0 && v.y >= 0 && v.z >= 0 && v.x < count_.x && v.y < count_.y && v.z < count_.z;
    }
    size_t IndexOf(const glm::ivec3 &v) const { return (size_t(1) * v.z * count_.y + v.y) * count_.x + v.x; }
    glm::ivec3 count_;
    Vector3 perCell_;
};

}  // namespace pbrt
