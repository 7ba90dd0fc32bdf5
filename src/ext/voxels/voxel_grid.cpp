#include "ext/voxels/voxel_grid.h"

#include <fmt/format.h>

namespace ext {

VoxelGrid::VoxelGrid(const Bounds3 &bounds, int voxels) {
    if (bounds.IsEmpty()) return;
    low_ = bounds.low;
    Vector3 extent = bounds.Diagonal();
    Float longest = MaxComponent(extent);
    for (int i = 0; i < 3; ++i) {
        if (!(extent[i] > 0)) continue;
        auto n = int(std::lround(extent[i] / longest * Float(voxels)));
        resolution_[i] = std::max(1, n);
        scale_[i] = Float(resolution_[i]) / extent[i];
        size_[i] = extent[i] / Float(resolution_[i]);
    }
}

size_t VoxelGrid::BorderSize() const {
    glm::ivec3 inner = glm::max(resolution_ - 2, glm::ivec3(0));
    return Size() - size_t(inner.x) * size_t(inner.y) * size_t(inner.z);
}

std::string VoxelGrid::Describe() const {
    return fmt::format("grid of {} x {} x {} voxels, {:.4g} x {:.4g} x {:.4g} each\n", resolution_.x, resolution_.y,
                       resolution_.z, size_.x, size_.y, size_.z);
}

}  // namespace ext
