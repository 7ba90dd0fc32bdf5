#pragma once
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "pbrt/math/bounds.h"

namespace ext {
using namespace pbrt;

/// The frozen structure: an adaptive octree over the scene bounds, every leaf with a distribution over groups of lights.
/// One array of 4-byte nodes, one array of distributions; look-up is index arithmetic.
class LightOctree {
  public:
    /// Row of the leaf's distribution for a point; points outside the bounds belong to the nearest cell.
    uint32_t Row(const Point3 &p) const;
    /// Running sums of the distribution, one per group; the last is 1.
    std::span<const Float> Cdf(uint32_t row) const { return {cdf_.data() + size_t(row) * groups_, groups_}; }

    size_t LeafCount() const { return leaves_; }
    size_t RowCount() const { return groups_ ? cdf_.size() / groups_ : 0; }
    int Depth() const { return depth_; }  ///< levels of cells below the bounds, the 4x4x4 grid counting 2
    size_t Bytes() const { return nodes_.capacity() * sizeof(uint32_t) + cdf_.capacity() * sizeof(Float); }
    /// Same cells and same distributions, to the last bit.
    bool operator==(const LightOctree &o) const { return low_ == o.low_ && scale_ == o.scale_ && nodes_ == o.nodes_ && cdf_ == o.cdf_; }

    /// The cell a point falls in, for views and tests.
    struct Cell {
        Bounds3 bounds;
        uint32_t node = 0;  ///< identifies the leaf: index below NodeCount
        uint32_t row = 0;
        int depth = 0;
    };
    Cell CellAt(const Point3 &p) const;
    size_t NodeCount() const { return nodes_.size(); }
    /// Calls visit(node, row, depth) for every leaf.
    template <class Visit>
    void ForEachLeaf(Visit &&visit) const {
        for (uint32_t top = 0; top < std::min<size_t>(nodes_.size(), kTopNodes); ++top) VisitLeaves(top, 2, visit);
    }

    /// Cells per axis of the undivided top grid (paper, "Implementation Details").
    static constexpr int TopCells = 4;
    /// Deepest level; positions are quantised to 21 bits an axis.
    static constexpr int MaxDepth = 21;

  private:
    friend class LightOctreeBuilder;
    static constexpr uint32_t LeafBit = 0x80000000u;
    static constexpr uint32_t kTopNodes = TopCells * TopCells * TopCells;
    template <class Visit>
    void VisitLeaves(uint32_t node, int depth, Visit &&visit) const {
        if (nodes_[node] & LeafBit) visit(node, nodes_[node] & ~LeafBit, depth);
        else
            for (uint32_t c = 0; c < 8; ++c) VisitLeaves(nodes_[node] + c, depth + 1, visit);
    }
    /// Cell coordinates at the deepest level.
    glm::uvec3 Quantize(const Point3 &p) const;

    Point3 low_{0, 0, 0};
    Vector3 scale_{0, 0, 0};  ///< to quantised units
    /// The first 64 are the top grid, x fastest; then blocks of 8 children. A leaf holds LeafBit | row, an inner node the
    /// index of its first child.
    std::vector<uint32_t> nodes_;
    std::vector<Float> cdf_;
    size_t groups_ = 0;
    size_t leaves_ = 0;
    int depth_ = 0;
};

}  // namespace ext
