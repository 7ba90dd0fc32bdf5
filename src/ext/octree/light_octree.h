#pragma once
#include <functional>
#include <numeric>
#include <span>
#include <vector>

#include "ext/visibility/visibility_tree.h"
#include "pbrt/core/parallel.h"

namespace ext {

/// The paper's structure: an adaptive octree over the scene bounds with a distribution over light groups per leaf.
class LightOctree {
  public:
    uint32_t Row(const Point3 &p) const { return cells_.Row(p); }
    /// CDF over groups; the last entry is 1.
    std::span<const Float> Cdf(uint32_t row) const { return {cdf_.data() + size_t(row) * groups_, groups_}; }

    const CellOctree &Cells() const { return cells_; }
    size_t LeafCount() const { return leaves_; }
    size_t RowCount() const { return groups_ ? cdf_.size() / groups_ : 0; }
    int Depth() const { return depth_; }  ///< levels below the bounds; the 4x4x4 grid counts 2
    size_t Bytes() const { return cells_.Bytes() + cdf_.capacity() * sizeof(Float); }
    /// Bitwise equality of cells and distributions.
    bool operator==(const LightOctree &o) const { return cells_ == o.cells_ && cdf_ == o.cdf_; }
    void Visit(auto &archive) { archive(cells_, cdf_, groups_, leaves_, depth_); }
    /// Empty if valid, else the error. An octree without rows is valid.
    std::optional<std::string> Validate() const {
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
    size_t GroupCount() const { return groups_; }

  private:
    friend class LightOctreeBuilder;
    CellOctree cells_;
    std::vector<Float> cdf_;
    size_t groups_ = 0;
    size_t leaves_ = 0;
    int depth_ = 0;
};

/// Builds a LightOctree from points (paper, section 4.1): a 4x4x4 grid whose cells are split while they hold more than
/// 4N/T points. A leaf's distribution is proportional to the mean of its points' vectors, one value per group.
class LightOctreeBuilder {
  public:
    /// `leafTarget`: the paper's T.
    LightOctreeBuilder(const Bounds3 &bounds, std::vector<Point3> points, int leafTarget) {
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

    /// Adds the values of point `index` (constructor order) to `sum`. Called in parallel for different leaves, in a
    /// fixed order within a leaf.
    using AddValues = std::function<void(uint32_t index, std::span<double> sum)>;
    /// Leaves without points or positive values use the nearest ancestor's distribution; uniform without one.
    LightOctree Build(size_t groups, const AddValues &addValues) {
        PBRT_CHECK(groups > 0);
        constexpr uint32_t kNone = 0xffffffffu;
        const size_t nodeCount = tree_.cells_.NodeCount();
        // The last sum and row are those of the root, kNoParent.
        std::vector<double> sums((nodeCount + 1) * groups, 0.0);
        std::vector<uint32_t> rowOf(nodeCount + 1, kNone);
        auto placeOf = [&](size_t node) { return std::min(node, nodeCount); };
        auto sumOf = [&](size_t node) { return std::span<double>(sums.data() + placeOf(node) * groups, groups); };
        auto isLeaf = [&](size_t node) { return isLeaf_[node] != 0; };

        ParallelForEach(int64_t(nodeCount), 64, [&](int64_t node) {
            if (!isLeaf(node)) return;
            for (uint32_t i = rangeOf_[node].begin; i < rangeOf_[node].end; ++i) addValues(order_[i], sumOf(node));
        });
        // Children follow their parents, so one backward pass adds every node to its parent, the top cells to the root.
        for (size_t node = nodeCount; node-- > 0;) {
            std::span<double> from = sumOf(node), into = sumOf(parentOf_[node]);
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
        // Row of the nearest ancestor (or self) with a positive sum; created on first use.
        auto rowFor = [&](uint32_t node) {
            while (node != kNoParent && !(total(sumOf(node)) > 0)) node = parentOf_[node];
            uint32_t &row = rowOf[placeOf(node)];
            if (row == kNone) row = addRow(sumOf(node));
            return row;
        };
        for (uint32_t node = 0; node < nodeCount; ++node)
            if (isLeaf(node)) tree_.cells_.SetLeaf(node, rowFor(node));
        tree_.cells_.ShrinkToFit();
        tree_.cdf_.shrink_to_fit();
        return std::move(tree_);
    }

    size_t LeafCount() const { return tree_.leaves_; }  ///< number of leaves, including empty ones
    /// Number of points per node, indexed by CellOctree::Cell::node. Valid before and after Build.
    std::vector<uint32_t> PointsPerNode() const {
        std::vector<uint32_t> counts;
        counts.reserve(rangeOf_.size());
        for (const Range &r : rangeOf_) counts.push_back(r.end - r.begin);
        return counts;
    }

  private:
    static constexpr uint32_t kNoParent = 0xffffffffu;
    static constexpr int kTopBit = CellOctree::MaxDepth - 2;
    struct Range {
        uint32_t begin = 0, end = 0;
    };
    void Subdivide(uint32_t node, Range range, int bit) {
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

    LightOctree tree_;
    std::vector<glm::uvec3> quantized_;  ///< per original point
    std::vector<uint32_t> order_;        ///< original indices, grouped by cell
    size_t splitAbove_ = 0;
    std::vector<Range> rangeOf_;      ///< per node
    std::vector<uint8_t> isLeaf_;     ///< per node
    std::vector<uint32_t> parentOf_;  ///< per node; top cells: none
};

}  // namespace ext
