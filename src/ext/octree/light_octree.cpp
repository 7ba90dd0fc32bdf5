#include "ext/octree/light_octree.h"

namespace ext {

namespace {
/// Which of the 8 children, from the coordinates' bits at this level. x is the lowest bit.
uint32_t ChildIndex(const glm::uvec3 &q, int bit) {
    return ((q.x >> bit) & 1) | (((q.y >> bit) & 1) << 1) | (((q.z >> bit) & 1) << 2);
}
}  // namespace

glm::uvec3 LightOctree::Quantize(const Point3 &p) const {
    constexpr Float kLargest = (1 << MaxDepth) - 1;
    Vector3 q = glm::clamp((p - low_) * scale_, Vector3(0), Vector3(kLargest));
    return glm::uvec3(q);
}

uint32_t LightOctree::Row(const Point3 &p) const {
    glm::uvec3 q = Quantize(p);
    int bit = MaxDepth - 2;
    uint32_t node = nodes_[(q.x >> bit) | ((q.y >> bit) << 2) | ((q.z >> bit) << 4)];
    while (!(node & LeafBit)) node = nodes_[node + ChildIndex(q, --bit)];
    return node & ~LeafBit;
}

LightOctree::Cell LightOctree::CellAt(const Point3 &p) const {
    glm::uvec3 q = Quantize(p);
    int bit = MaxDepth - 2;
    Cell cell;
    cell.node = (q.x >> bit) | ((q.y >> bit) << 2) | ((q.z >> bit) << 4);
    while (!(nodes_[cell.node] & LeafBit)) cell.node = nodes_[cell.node] + ChildIndex(q, --bit);
    cell.row = nodes_[cell.node] & ~LeafBit;
    cell.depth = MaxDepth - bit;
    Vector3 from((q >> uint32_t(bit)) << uint32_t(bit));
    Float size = static_cast<Float>(1u << bit);
    auto position = [&](const Vector3 &v) {
        Point3 r = low_;
        for (int i = 0; i < 3; ++i)
            if (scale_[i] > 0) r[i] += v[i] / scale_[i];
        return r;
    };
    cell.bounds = Bounds3(position(from), position(from + size));
    return cell;
}

}  // namespace ext
