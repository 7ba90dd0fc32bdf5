#include "ext/visibility/visibility_tree.h"

#include <fmt/format.h>

#include <map>

namespace ext {

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

std::optional<std::string> CellOctree::ValidateFor(size_t rows) const {
    if (!IsFinite(low_) || !IsPositive(scale_.x) || !IsPositive(scale_.y) || !IsPositive(scale_.z))
        return "the box of an octree is not finite";
    if (nodes_.size() < TopCount || (nodes_.size() - TopCount) % 8 != 0) return "an octree is incomplete";
    // Depth of each block of eight children; 0: unreachable. Children follow their parents.
    std::vector<uint8_t> depth((nodes_.size() - TopCount) / 8, 0);
    for (size_t i = 0; i < nodes_.size(); ++i) {
        const uint32_t node = nodes_[i];
        const int here = i < TopCount ? 2 : depth[(i - TopCount) / 8];
        if (here == 0) return "an octree has unreachable nodes";
        if (node & LeafBit) {
            if ((node & ~LeafBit) >= rows) return "a leaf of an octree has no row";
            continue;
        }
        const size_t block = (size_t(node) - TopCount) / 8;
        // Every earlier block has a depth; else an error was returned.
        if (node < TopCount || (node - TopCount) % 8 != 0 || block >= depth.size() || depth[block] != 0)
            return "nodes of an octree share children or have none";
        if (here == MaxDepth) return "an octree is too deep";
        depth[block] = uint8_t(here + 1);
    }
    return {};
}

std::string DescribeLeaves(const std::vector<LeafSize> &leaves) {
    struct Level {
        size_t leaves = 0, empty = 0;
        uint64_t records = 0;
    };
    std::map<int, Level> levels;
    std::vector<uint32_t> perLeaf;
    for (const LeafSize &leaf : leaves) {
        Level &level = levels[leaf.depth];
        ++level.leaves;
        level.empty += leaf.records == 0;
        level.records += leaf.records;
        perLeaf.push_back(leaf.records);
    }
    if (perLeaf.empty()) return "";
    std::sort(perLeaf.begin(), perLeaf.end());
    auto quantile = [&](double q) { return perLeaf[size_t(q * double(perLeaf.size() - 1) + 0.5)]; };

    std::string text = "depth     leaves    without records    records    records per leaf\n";
    for (const auto &[depth, level] : levels)
        text += fmt::format("{:5} {:10} {:18} {:10} {:19.1f}\n", depth, level.leaves, level.empty, level.records,
                            double(level.records) / double(level.leaves));
    text += "records per leaf, all leaves: ";
    for (double q : {0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 1.0}) text += fmt::format(" {:g} %: {} ", 100 * q, quantile(q));
    auto firstFilled = std::upper_bound(perLeaf.begin(), perLeaf.end(), 0u);
    if (auto filled = perLeaf.end() - firstFilled; filled > 0)
        text += fmt::format("\nmedian of the {} leaves with records: {}", filled, firstFilled[filled / 2]);
    return text + "\n";
}

CellOctree::CellOctree(const Bounds3 &bounds) {
    if (bounds.IsEmpty()) return;
    low_ = bounds.low;
    for (int i = 0; i < 3; ++i) {
        const Float scale = Float(1 << MaxDepth) / (bounds.high[i] - bounds.low[i]);
        // Infinite if the extent is zero or too small to divide.
        scale_[i] = std::isfinite(scale) ? scale : 0;
    }
}

const std::array<Float, 256> &VisibilityTree::Table() {
    static const std::array<Float, 256> table = [] {
        std::array<Float, 256> t;
        for (int i = 0; i < 256; ++i) t[i] = std::exp2((Float(i) - 192) / 8);
        return t;
    }();
    return table;
}

}  // namespace ext
