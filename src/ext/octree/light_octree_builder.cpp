#include "ext/octree/light_octree_builder.h"

#include <numeric>

#include "pbrt/core/error.h"
#include "pbrt/core/parallel.h"

namespace ext {
namespace {
constexpr uint32_t kNoParent = 0xffffffffu;
constexpr int kTopBit = CellOctree::MaxDepth - 2;
}  // namespace

LightOctreeBuilder::LightOctreeBuilder(const Bounds3 &bounds, std::vector<Point3> points, int leafTarget) {
    tree_.cells_ = CellOctree(bounds);
    quantized_.resize(points.size());
    for (size_t i = 0; i < points.size(); ++i) quantized_[i] = tree_.cells_.Quantize(points[i]);
    splitAbove_ = std::max<size_t>(1, 4 * points.size() / size_t(leafTarget));

    constexpr uint32_t kTop = CellOctree::TopCount;
    std::vector<uint32_t> start(kTop + 1, 0);
    for (const glm::uvec3 &q : quantized_) ++start[CellOctree::TopCell(q) + 1];
    std::partial_sum(start.begin(), start.end(), start.begin());
    order_.resize(points.size());
    std::vector<uint32_t> next(start.begin(), start.end() - 1);
    for (uint32_t i = 0; i < quantized_.size(); ++i) order_[next[CellOctree::TopCell(quantized_[i])]++] = i;

    rangeOf_.resize(kTop);
    parentOf_.assign(kTop, kNoParent);
    isLeaf_.resize(kTop);
    for (uint32_t cell = 0; cell < kTop; ++cell) Subdivide(cell, {start[cell], start[cell + 1]}, kTopBit);
}

void LightOctreeBuilder::Subdivide(uint32_t node, Range range, int bit) {
    rangeOf_[node] = range;
    isLeaf_[node] = range.end - range.begin <= splitAbove_ || bit == 0;
    if (isLeaf_[node]) {  // Build sets the row
        ++tree_.leaves_;
        tree_.depth_ = std::max(tree_.depth_, CellOctree::MaxDepth - bit);
        return;
    }
    uint32_t start[9];
    SortIntoChildren(quantized_, order_, range.begin, range.end, bit - 1, start);
    const uint32_t first = tree_.cells_.Split(node);
    rangeOf_.resize(first + 8);
    parentOf_.resize(first + 8, node);
    isLeaf_.resize(first + 8);
    for (uint32_t c = 0; c < 8; ++c) Subdivide(first + c, {start[c], start[c + 1]}, bit - 1);
}

LightOctree LightOctreeBuilder::Build(size_t groups, const AddValues &addValues) {
    PBRT_CHECK(groups > 0);
    const size_t nodeCount = tree_.cells_.NodeCount();
    std::vector<double> sums(nodeCount * groups, 0.0);
    auto sumOf = [&](size_t node) { return std::span<double>(sums.data() + node * groups, groups); };
    auto isLeaf = [&](size_t node) { return isLeaf_[node] != 0; };

    ParallelFor(int64_t(nodeCount), 64, [&](int64_t begin, int64_t end) {
        for (auto node = size_t(begin); node < size_t(end); ++node)
            if (isLeaf(node))
                for (uint32_t i = rangeOf_[node].begin; i < rangeOf_[node].end; ++i) addValues(order_[i], sumOf(node));
    });
    // Children follow their parents, so one backward pass adds every node to its parent, and the top cells to the root.
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
            running += whole > 0 ? s[g] / whole : 1.0 / double(groups);
            tree_.cdf_.push_back(g + 1 == groups ? Float(1) : Float(std::min(running, 1.0)));
        }
        return uint32_t(tree_.RowCount() - 1);
    };
    constexpr uint32_t kNone = 0xffffffffu;
    std::vector<uint32_t> rowOf(nodeCount, kNone);
    uint32_t rootRow = kNone;
    // Row of the nearest ancestor (or self) with a positive sum; created on first use.
    auto rowFor = [&](uint32_t node) {
        while (node != kNoParent && !(total(sumOf(node)) > 0)) node = parentOf_[node];
        uint32_t &row = node == kNoParent ? rootRow : rowOf[node];
        if (row == kNone)
            row = addRow(node == kNoParent ? std::span<const double>(all) : std::span<const double>(sumOf(node)));
        return row;
    };
    for (uint32_t node = 0; node < nodeCount; ++node)
        if (isLeaf(node)) tree_.cells_.SetLeaf(node, rowFor(node));
    tree_.cells_.ShrinkToFit();
    tree_.cdf_.shrink_to_fit();
    return std::move(tree_);
}

std::optional<std::string> LightOctree::Validate() const {
    if (groups_ == 0 || cdf_.empty()) {
        const bool isEmpty = groups_ == 0 && cdf_.empty() && leaves_ == 0 && depth_ == 0;
        return isEmpty ? std::nullopt : std::optional("an octree has lights and no rows");
    }
    if (cdf_.size() % groups_ != 0) return "a row of an octree lacks lights";
    for (uint32_t row = 0; row < RowCount(); ++row) {
        const std::span<const Float> cdf = Cdf(row);
        if (!(cdf[0] >= 0) || cdf.back() != 1 || !std::is_sorted(cdf.begin(), cdf.end()))
            return "the probabilities of a row do not add up to 1";
    }
    return cells_.ValidateLeaves(RowCount(), leaves_, depth_);
}

}  // namespace ext
