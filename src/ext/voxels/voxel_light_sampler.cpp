#include "ext/voxels/voxel_light_sampler.h"

#include <fmt/format.h>
#include <algorithm>

namespace ext {

VoxelGrid::VoxelGrid(const Bounds3 &bounds, int voxels) {
    if (bounds.IsEmpty()) return;
    low_ = bounds.low;
    Vector3 extent = bounds.Diagonal();
    Float longest = MaxComponent(extent);
    for (int i = 0; i < 3; ++i) {
        if (!(extent[i] > 0)) continue;
        resolution_[i] = std::max(1, int(std::lround(extent[i] / longest * Float(voxels))));
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

void BuildFixedCdf(std::span<const double> weights, std::span<uint32_t> begins) {
    const size_t n = weights.size();
    PBRT_CHECK(n == begins.size() && n < (uint64_t(1) << 32));
    double total = 0;
    for (double w : weights) total += w;
    // The remainder after one unit per entry is distributed in proportion.
    const double units = double((uint64_t(1) << 32) - n);
    double running = 0;
    for (size_t i = 0; i < n; ++i) {
        begins[i] = uint32_t(std::min(running, 1.0) * units) + uint32_t(i);
        running += total > 0 ? weights[i] / total : 1 / double(n);
    }
}

uint32_t SampleFixedCdf(std::span<const uint32_t> begins, Float u, const Point3 &p) {
    // Float spacing at u, in units; less than one below 2^-8.
    auto spacing = (std::bit_cast<uint32_t>(u) & 0x7f800000u);
    auto fine = double(std::bit_cast<Float>(spacing) * 0x1p-23f) * 0x1p32;
    auto target = double(u) * 0x1p32 + fine * double(HashFloat(p, u));
    auto unit = uint32_t(std::min(target, 0x1.fffffffep31));
    return uint32_t(std::upper_bound(begins.begin(), begins.end(), unit) - begins.begin()) - 1;
}

}  // namespace ext
