#include "ext/octree/cell_octree.h"

namespace ext {

CellOctree::CellOctree(const Bounds3 &bounds) {
    if (bounds.IsEmpty()) return;
    low_ = bounds.low;
    for (int i = 0; i < 3; ++i) {
        Float extent = bounds.high[i] - bounds.low[i];
        scale_[i] = extent > 0 ? static_cast<Float>(1 << MaxDepth) / extent : 0;
    }
}

CellOctree::Cell CellOctree::CellAt(const Point3 &p) const {
    glm::uvec3 q = Quantize(p);
    int bit = MaxDepth - 2;
    uint32_t node = nodes_[TopCell(q)];
    while (!(node & LeafBit)) node = nodes_[node + Child(q, --bit)];
    Cell cell;
    cell.row = node & ~LeafBit;
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
