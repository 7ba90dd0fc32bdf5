// Validates the content of learned structures read from files; loading has validated the lengths.
#include "ext/visibility/visibility_tree.h"

#include <algorithm>
#include <cmath>

#include "ext/visibility/visibility_records.h"

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

namespace {

bool IsFinite(const Vector3 &v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }
bool IsPositive(Float v) { return v >= 0 && std::isfinite(v); }

}  // namespace

std::optional<std::string> CellOctree::ValidateFor(size_t rows) const {
    if (!IsFinite(low_) || !IsPositive(scale_.x) || !IsPositive(scale_.y) || !IsPositive(scale_.z))
        return "the box of an octree is not finite";
    if (nodes_.size() < TopCount || (nodes_.size() - TopCount) % 8 != 0) return "an octree lacks nodes";
    // Depth of each block of eight children; 0: unreachable. Children follow their parents.
    std::vector<uint8_t> depth((nodes_.size() - TopCount) / 8, 0);
    for (size_t i = 0; i < nodes_.size(); ++i) {
        const uint32_t node = nodes_[i];
        const int here = i < TopCount ? 2 : depth[(i - TopCount) / 8];
        if (here == 0) return "a node of an octree is not reached";
        if (node & LeafBit) {
            if ((node & ~LeafBit) >= rows) return "a leaf of an octree has no row";
            continue;
        }
        const size_t block = (size_t(node) - TopCount) / 8;
        if (node <= i || node < TopCount || (node - TopCount) % 8 != 0 || block >= depth.size() || depth[block] != 0)
            return "a node of an octree has no children of its own";
        if (here == MaxDepth) return "an octree is too deep";
        depth[block] = uint8_t(here + 1);
    }
    return {};
}

std::optional<std::string> CellOctree::ValidateLeaves(size_t rows, size_t leaves, int depth) const {
    if (std::optional<std::string> fault = ValidateFor(rows)) return fault;
    std::vector<bool> used(rows, false);
    size_t count = 0;
    int deepest = 0;
    ForEachLeaf([&](uint32_t, uint32_t row, int at) {
        ++count;
        used[row] = true;
        deepest = std::max(deepest, at);
    });
    if (std::find(used.begin(), used.end(), false) != used.end()) return "a row belongs to no leaf";
    // Leaves above the top grid cover several of its cells.
    if (leaves < rows || leaves > count || (deepest > 2 ? depth != deepest : depth < 0 || depth > 2))
        return "the numbers of leaves and levels do not fit the octree";
    return {};
}

std::optional<std::string> VisibilityTree::Validate() const {
    if (RowCount() == 0) {
        const bool isEmpty = offset_.empty() && nodes_.empty() && codes_.empty() && leaves_ == 0 && depth_ == 0;
        return isEmpty ? std::nullopt : std::optional("an octree has leaves and no rows");
    }
    if (offset_[0] != 0 || offset_.back() != codes_.size() || (!nodes_.empty() && nodes_.size() != codes_.size()) ||
        std::adjacent_find(offset_.begin(), offset_.end(), std::greater_equal<>()) != offset_.end())
        return "the rows of an octree do not follow each other";
    return cells_.ValidateLeaves(RowCount(), leaves_, depth_);
}

std::optional<std::string> VisibilityRecords::ValidateFor(size_t groups, const LightTree *lights) const {
    size_t next = 0;
    for (const VisibilityRecord &r : records) {
        if (r.firstRay != next || r.rayCount == 0 || r.rayCount > rays.size() - next)
            return "the shadow rays of records do not follow each other";
        if (!IsFinite(r.p)) return "a record lies at no finite place";
        next += r.rayCount;
    }
    if (next != rays.size()) return "shadow rays belong to no record";
    for (const ShadowRay &t : rays) {
        if (t.light >= groups || (lights && lights->PositionOf(t.light) == LightTree::kNowhere))
            return "a shadow ray goes to a light that does not exist";
        if (!IsPositive(t.share) || !IsPositive(t.weight) || !IsPositive(t.ratio))
            return "the contribution of a shadow ray is not finite";
    }
    return {};
}

const std::array<Float, 256> &VisibilityTree::Table() {
    static const std::array<Float, 256> table = [] {
        std::array<Float, 256> t;
        for (int i = 0; i < 256; ++i) t[size_t(i)] = std::exp2((Float(i) - 192) / 8);
        return t;
    }();
    return table;
}

}  // namespace ext
