#include "ext/visibility/cell_octree.h"

#include <algorithm>

namespace ext {

CellOctree::CellOctree(const Bounds3 &bounds) {
    if (bounds.IsEmpty()) return;
    low_ = bounds.low;
    for (int i = 0; i < 3; ++i) {
        const Float scale = Float(1 << MaxDepth) / (bounds.high[i] - bounds.low[i]);
        // Infinite if the extent is zero or too small to divide.
        scale_[i] = std::isfinite(scale) ? scale : 0;
    }
}

CellOctree::Cell CellOctree::CellAt(const Point3 &p) const {
    glm::uvec3 q = Quantize(p);
    int bit = MaxDepth - 2;
    Cell cell;
    cell.node = TopCell(q);
    while (!(nodes_[cell.node] & LeafBit)) cell.node = nodes_[cell.node] + Child(q, --bit);
    cell.row = nodes_[cell.node] & ~LeafBit;
    cell.depth = MaxDepth - bit;
    Vector3 from((q >> uint32_t(bit)) << uint32_t(bit));
    Float size = Float(1u << bit);
    auto position = [&](const Vector3 &v) {
        Point3 r = low_;
        for (int i = 0; i < 3; ++i)
            if (scale_[i] > 0) r[i] += v[i] / scale_[i];
        return r;
    };
    cell.bounds = Bounds3(position(from), position(from + size));
    return cell;
}

void SortIntoChildren(const std::vector<glm::uvec3> &quantized, std::vector<uint32_t> &order, uint32_t begin,
                      uint32_t end, int bit, uint32_t start[9]) {
    std::fill(start, start + 9, 0u);
    start[0] = begin;
    for (uint32_t i = begin; i < end; ++i) ++start[CellOctree::Child(quantized[order[i]], bit) + 1];
    for (int c = 1; c < 9; ++c) start[c] += start[c - 1];
    std::vector<uint32_t> sorted(end - begin);
    uint32_t next[8];
    std::copy(start, start + 8, next);
    for (uint32_t i = begin; i < end; ++i)
        sorted[next[CellOctree::Child(quantized[order[i]], bit)]++ - begin] = order[i];
    std::copy(sorted.begin(), sorted.end(), order.begin() + begin);
}

}  // namespace ext
