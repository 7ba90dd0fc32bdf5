#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "pbrt/core/state_io.h"
#include "pbrt/math/bounds.h"

namespace ext {
using namespace pbrt;

// For the validation of learned structures read from files; loading has validated the lengths.
inline bool IsFinite(const Vector3 &v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }
inline bool IsPositive(Float v) { return v >= 0 && std::isfinite(v); }

/// Octree over a box that maps a point to the row of its leaf. A single array of 4-byte nodes; look-up is index
/// arithmetic without pointers. The row's content is defined by the caller.
class CellOctree {
  public:
    static constexpr int TopCells = 4;  ///< cells per axis of the undivided top grid (paper, "Implementation Details")
    static constexpr uint32_t TopCount = TopCells * TopCells * TopCells;
    /// Deepest level; positions are quantized to 21 bits per axis. The top grid is level 2.
    static constexpr int MaxDepth = 21;

    CellOctree() = default;
    explicit CellOctree(const Bounds3 &bounds);

    /// Row of the leaf that contains p; points outside are clamped to the bounds.
    uint32_t Row(const Point3 &p) const {
        glm::uvec3 q = Quantize(p);
        int bit = MaxDepth - 2;
        uint32_t node = nodes_[TopCell(q)];
        while (!(node & LeafBit)) node = nodes_[node + Child(q, --bit)];
        return node & ~LeafBit;
    }
    /// Cell that contains a point, for inspection and tests.
    struct Cell {
        Bounds3 bounds;
        uint32_t node = 0;  ///< leaf index, below NodeCount
        uint32_t row = 0;
        int depth = 0;
    };
    Cell CellAt(const Point3 &p) const {
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
    size_t NodeCount() const { return nodes_.size(); }
    /// Calls act(node, row, depth) for every leaf.
    void ForEachLeaf(auto &&act) const {
        for (uint32_t top = 0; top < TopCount; ++top) VisitLeaves(top, 2, act);
    }
    size_t Bytes() const { return nodes_.capacity() * sizeof(uint32_t); }
    bool operator==(const CellOctree &o) const = default;

    /// Cell coordinates at the deepest level; 0 for NaN.
    glm::uvec3 Quantize(const Point3 &p) const {
        constexpr Float kMax = (1 << MaxDepth) - 1;
        // Argument order matters: max(0, NaN) is 0.
        return glm::uvec3(glm::min(glm::max(Vector3(0), (p - low_) * scale_), Vector3(kMax)));
    }
    static uint32_t TopCell(const glm::uvec3 &q) {
        constexpr int bit = MaxDepth - 2;
        return (q.x >> bit) | ((q.y >> bit) << 2) | ((q.z >> bit) << 4);
    }
    /// Child index (0 to 7) from the coordinate bits at this level; x is the lowest bit.
    static uint32_t Child(const glm::uvec3 &q, int bit) {
        return ((q.x >> bit) & 1) | (((q.y >> bit) & 1) << 1) | (((q.z >> bit) & 1) << 2);
    }

    /// For builders: the first TopCount nodes are the top grid, x fastest, followed by blocks of 8 children.
    void SetLeaf(uint32_t node, uint32_t row) { nodes_[node] = LeafBit | row; }
    /// Makes `node` an inner node and returns the index of its first child.
    uint32_t Split(uint32_t node) {
        auto first = uint32_t(nodes_.size());
        nodes_[node] = first;
        nodes_.resize(first + 8, LeafBit);
        return first;
    }
    void ShrinkToFit() { nodes_.shrink_to_fit(); }
    void Visit(auto &archive) {
        archive(low_, scale_);
        archive.Structure(nodes_);
    }
    /// Empty if valid, else why look-ups would not terminate or reach a row beyond `rows`.
    std::optional<std::string> ValidateFor(size_t rows) const;
    /// ValidateFor; also tests that every row has a leaf, and the number of leaves and levels.
    std::optional<std::string> ValidateLeaves(size_t rows, size_t leaves, int depth) const {
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

  private:
    void VisitLeaves(uint32_t node, int depth, auto &&act) const {
        if (nodes_[node] & LeafBit) act(node, nodes_[node] & ~LeafBit, depth);
        else
            for (uint32_t c = 0; c < 8; ++c) VisitLeaves(nodes_[node] + c, depth + 1, act);
    }
    static constexpr uint32_t LeafBit = 0x80000000u;
    Point3 low_{0, 0, 0};
    Vector3 scale_{0, 0, 0};  ///< to quantized units; 0 along undivided axes
    std::vector<uint32_t> nodes_ =
        std::vector<uint32_t>(TopCount, LeafBit);  ///< LeafBit | row, or index of the first child
};

/// Stable-sorts order[begin, end), indices into `quantized`, by child at this level; child c gets order[start[c],
/// start[c + 1]).
void SortIntoChildren(const std::vector<glm::uvec3> &quantized, std::vector<uint32_t> &order, uint32_t begin,
                      uint32_t end, int bit, uint32_t start[9]);

/// The visibility model's structure: an octree whose leaves have rows of correction factors a(leaf, l). Factors are per
/// light or, with many lights, per node of a cut through the light tree. 8 bits per factor on a logarithmic scale;
/// equal rows are shared.
class VisibilityTree {
  public:
    /// Parallel `nodes` (ascending) and `codes`. With few lights, rows cover all of them and `nodes` is empty.
    struct Row {
        std::span<const uint32_t> nodes;
        std::span<const uint8_t> codes;
    };
    Row RowAt(const Point3 &p) const { return GetRow(RowCount() == 1 ? 0 : cells_.Row(p)); }
    Row GetRow(uint32_t row) const {
        const uint32_t begin = offset_[row], count = offset_[row + 1] - begin;
        return {nodes_.empty() ? std::span<const uint32_t>() : std::span<const uint32_t>(nodes_.data() + begin, count),
                {codes_.data() + begin, count}};
    }
    /// Factor of a code: 2^((code - 192) / 8), steps of 9 %, from 6e-8 to 235.
    static Float Decode(uint8_t code) { return Table()[code]; }
    static uint8_t Encode(double factor) {
        return uint8_t(std::clamp(std::lround(192 + 8 * std::log2(std::max(factor, 1e-12))), 0l, 255l));
    }

    const CellOctree &Cells() const { return cells_; }
    size_t LeafCount() const { return leaves_; }
    size_t RowCount() const { return offset_.empty() ? 0 : offset_.size() - 1; }
    int Depth() const { return depth_; }  ///< levels below the root; 0: a single leaf
    size_t Bytes() const {
        return cells_.Bytes() + offset_.capacity() * sizeof(uint32_t) + nodes_.capacity() * sizeof(uint32_t) +
               codes_.capacity();
    }
    bool operator==(const VisibilityTree &o) const = default;
    void Visit(auto &archive) {
        archive(cells_);
        archive.Structure(offset_);
        archive.Structure(nodes_);
        archive(codes_, leaves_, depth_);
    }
    /// Empty if valid, else the error. A tree without rows is valid.
    std::optional<std::string> Validate() const {
        if (RowCount() == 0) {
            const bool isEmpty = offset_.empty() && nodes_.empty() && codes_.empty() && leaves_ == 0 && depth_ == 0;
            return isEmpty ? std::nullopt : std::optional("an octree has leaves and no rows");
        }
        if (offset_[0] != 0 || offset_.back() != codes_.size() || (!nodes_.empty() && nodes_.size() != codes_.size()) ||
            std::adjacent_find(offset_.begin(), offset_.end(), std::greater_equal<>()) != offset_.end())
            return "the rows of an octree do not follow each other";
        return cells_.ValidateLeaves(RowCount(), leaves_, depth_);
    }

    static const std::array<Float, 256> &Table();  ///< Decode of every code

  private:
    friend class VisibilityTreeBuilder;
    CellOctree cells_;
    std::vector<uint32_t> offset_;  ///< start of each row in nodes_ and codes_; one more entry at the end
    std::vector<uint32_t> nodes_;
    std::vector<uint8_t> codes_;
    size_t leaves_ = 0;
    int depth_ = 0;
};

struct LeafSize {
    int depth = 0;
    uint32_t records = 0;
};

/// Leaves and records by depth, and quantiles of records per leaf, as text.
std::string DescribeLeaves(const std::vector<LeafSize> &leaves);

}  // namespace ext
