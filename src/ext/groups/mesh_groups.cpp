#include "ext/groups/mesh_groups.h"

#include <algorithm>

namespace ext {

MeshGroups::MeshGroups(const LightTable &lights, bool grouped) {
    std::span<const LightCandidate> single = lights.Candidates();
    size_t n = lights.Size();
    groupOf_.resize(n);
    share_.resize(n);
    cdf_.resize(n);
    for (size_t i = 0; i < n;) {
        size_t end = i + 1;
        ShapeId mesh = lights.MeshOf(LightId(i));
        if (grouped && mesh)
            while (end < n && lights.MeshOf(LightId(end)) == mesh) ++end;

        LightCandidate group;
        group.infinite = single[i].infinite;
        double power = 0;
        for (size_t k = i; k < end; ++k) {
            power += static_cast<double>(single[k].power);
            if (!single[k].bounds) continue;
            group.bounds = group.bounds ? Union(*group.bounds, *single[k].bounds) : *single[k].bounds;
        }
        group.power = static_cast<Float>(power);
        double running = 0;
        for (size_t k = i; k < end; ++k) {
            double share = power > 0 ? static_cast<double>(single[k].power) / power : 1.0 / static_cast<double>(end - i);
            running += share;
            groupOf_[k] = static_cast<uint32_t>(candidates_.size());
            share_[k] = static_cast<Float>(share);
            cdf_[k] = static_cast<Float>(running);
        }
        first_.push_back(static_cast<uint32_t>(i));
        candidates_.push_back(group);
        i = end;
    }
    first_.push_back(static_cast<uint32_t>(n));
}

LightId MeshGroups::SampleLight(uint32_t group, Float u) const {
    uint32_t begin = first_[group], end = first_[group + 1];
    if (end - begin == 1) return LightId(begin);
    auto it = std::upper_bound(cdf_.begin() + begin, cdf_.begin() + end, u);
    auto index = static_cast<uint32_t>(it - cdf_.begin());
    if (index == end) {  // rounding left the last sum below 1: the last light with a share takes the rest
        index = end - 1;
        while (index > begin && share_[index] == 0) --index;
    }
    return LightId(index);
}

size_t MeshGroups::Bytes() const {
    return candidates_.capacity() * sizeof(LightCandidate) + (first_.capacity() + groupOf_.capacity()) * sizeof(uint32_t) +
           (share_.capacity() + cdf_.capacity()) * sizeof(Float);
}

}  // namespace ext
