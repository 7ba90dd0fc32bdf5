#include "ext/octree/light_octree_builder.h"

#include <numeric>

#include "pbrt/core/error.h"
#include "pbrt/core/parallel.h"

namespace ext {

namespace {
constexpr uint32_t kNoParent = 0xffffffffu;
constexpr int kTopBit = LightOctree::MaxDepth - 2;
}  // namespace

LightOctreeBuilder::LightOctreeBuilder(const Bounds3 &bounds, std::vector<Point3> points, int leafTarget) {
    if (!bounds.IsEmpty()) {
        tree_.low_ = bounds.low;
        for (int i = 0; i < 3; ++i) {
            Float extent = bounds.high[i] - bounds.low[i];
            tree_.scale_[i] = extent > 0 ? static_cast<Float>(1 << LightOctree::MaxDepth) / extent : 0;
        }
    }
    quantized_.resize(points.size());
    for (size_t i = 0; i < points.size(); ++i) quantized_[i] = tree_.Quantize(points[i]);
    splitAbove_ = std::max<size_t>(1, 4 * points.size() / static_cast<size_t>(leafTarget));

    // Counting sort into the top grid.
    constexpr uint32_t kTop = LightOctree::TopCells * LightOctree::TopCells * LightOctree::TopCells;
    auto topCell = [&](const glm::uvec3 &q) { return (q.x >> kTopBit) | ((q.y >> kTopBit) << 2) | ((q.z >> kTopBit) << 4); };
    std::vector<uint32_t> start(kTop + 1, 0);
    for (const glm::uvec3 &q : quantized_) ++start[topCell(q) + 1];
    std::partial_sum(start.begin(), start.end(), start.begin());
    order_.resize(points.size());
    std::vector<uint32_t> next(start.begin(), start.end() - 1);
    for (uint32_t i = 0; i < quantized_.size(); ++i) order_[next[topCell(quantized_[i])]++] = i;

    tree_.nodes_.resize(kTop);
    rangeOf_.resize(kTop);
    parentOf_.assign(kTop, kNoParent);
    for (uint32_t cell = 0; cell < kTop; ++cell) Subdivide(cell, {start[cell], start[cell + 1]}, kTopBit);
}

void LightOctreeBuilder::Split(Range range, int bit, Range children[8]) {
    auto child = [&](uint32_t index) {
        const glm::uvec3 &q = quantized_[index];
        return ((q.x >> bit) & 1) | (((q.y >> bit) & 1) << 1) | (((q.z >> bit) & 1) << 2);
    };
    uint32_t count[8] = {};
    for (uint32_t i = range.begin; i < range.end; ++i) ++count[child(order_[i])];
    uint32_t next[8];
    for (uint32_t c = 0, at = range.begin; c < 8; ++c) {
        children[c] = {at, at + count[c]};
        next[c] = at;
        at += count[c];
    }
    // Stable, so that the order within a leaf is the order of the input.
    std::vector<uint32_t> sorted(range.end - range.begin);
    for (uint32_t i = range.begin; i < range.end; ++i) sorted[next[child(order_[i])]++ - range.begin] = order_[i];
    std::copy(sorted.begin(), sorted.end(), order_.begin() + range.begin);
}

void LightOctreeBuilder::Subdivide(uint32_t node, Range range, int bit) {
    rangeOf_[node] = range;
    if (range.end - range.begin <= splitAbove_ || bit == 0) {
        tree_.nodes_[node] = LightOctree::LeafBit;  // the row comes with Build
        ++tree_.leaves_;
        tree_.depth_ = std::max(tree_.depth_, LightOctree::MaxDepth - bit);
        return;
    }
    Range children[8];
    Split(range, bit - 1, children);
    auto first = static_cast<uint32_t>(tree_.nodes_.size());
    tree_.nodes_[node] = first;
    tree_.nodes_.resize(first + 8);
    rangeOf_.resize(first + 8);
    parentOf_.resize(first + 8, node);
    for (uint32_t c = 0; c < 8; ++c) Subdivide(first + c, children[c], bit - 1);
}

LightOctree LightOctreeBuilder::Build(size_t groups, const AddValues &addValues) {
    PBRT_CHECK(groups > 0);
    const size_t nodeCount = tree_.nodes_.size();
    std::vector<double> sums(nodeCount * groups, 0.0);
    auto sumOf = [&](size_t node) { return std::span<double>(sums.data() + node * groups, groups); };
    auto isLeaf = [&](size_t node) { return (tree_.nodes_[node] & LightOctree::LeafBit) != 0; };

    // One task per leaf; big leaves first would balance better, but leaves are alike by construction.
    ParallelFor(static_cast<int64_t>(nodeCount), 64, [&](int64_t begin, int64_t end) {
        for (auto node = static_cast<size_t>(begin); node < static_cast<size_t>(end); ++node)
            if (isLeaf(node))
                for (uint32_t i = rangeOf_[node].begin; i < rangeOf_[node].end; ++i) addValues(order_[i], sumOf(node));
    });
    // Children come after their parents, so one pass from the back adds every node to its parent; then the whole scene.
    std::vector<double> all(groups, 0.0);
    for (size_t node = nodeCount; node-- > 0;) {
        std::span<double> into = parentOf_[node] == kNoParent ? std::span<double>(all) : sumOf(parentOf_[node]);
        std::span<double> from = sumOf(node);
        for (size_t g = 0; g < groups; ++g) into[g] += from[g];
    }
    auto total = [](std::span<const double> s) { return std::accumulate(s.begin(), s.end(), 0.0); };

    tree_.groups_ = groups;
    auto addRow = [&](std::span<const double> s) {
        double whole = total(s), running = 0;
        for (size_t g = 0; g < groups; ++g) {
            running += whole > 0 ? s[g] / whole : 1.0 / static_cast<double>(groups);
            tree_.cdf_.push_back(g + 1 == groups ? Float(1) : static_cast<Float>(std::min(running, 1.0)));
        }
        return static_cast<uint32_t>(tree_.RowCount() - 1);
    };
    constexpr uint32_t kNone = 0xffffffffu;
    std::vector<uint32_t> rowOf(nodeCount, kNone);
    uint32_t rootRow = kNone;
    // The row of the nearest ancestor (or self) that saw light; made when first needed.
    auto rowFor = [&](uint32_t node) {
        while (node != kNoParent && !(total(sumOf(node)) > 0)) node = parentOf_[node];
        uint32_t &row = node == kNoParent ? rootRow : rowOf[node];
        if (row == kNone) row = addRow(node == kNoParent ? std::span<const double>(all) : std::span<const double>(sumOf(node)));
        return row;
    };
    for (uint32_t node = 0; node < nodeCount; ++node)
        if (isLeaf(node)) tree_.nodes_[node] = LightOctree::LeafBit | rowFor(node);
    tree_.nodes_.shrink_to_fit();
    tree_.cdf_.shrink_to_fit();
    return std::move(tree_);
}

}  // namespace ext
