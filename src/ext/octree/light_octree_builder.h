#pragma once
#include <functional>
#include <vector>

#include "ext/octree/light_octree.h"

namespace ext {

/// Builds a LightOctree from points (paper, section 4.1): a 4x4x4 grid whose cells are split while they hold more than
/// 4N/T points. A leaf's distribution is proportional to the mean of its points' vectors, one value per group.
class LightOctreeBuilder {
  public:
    /// `leafTarget`: the paper's T.
    LightOctreeBuilder(const Bounds3 &bounds, std::vector<Point3> points, int leafTarget);

    /// Adds the values of point `index` (constructor order) to `sum`. Called in parallel for different leaves, in a
    /// fixed order within a leaf.
    using AddValues = std::function<void(uint32_t index, std::span<double> sum)>;
    /// Leaves without points or without positive values use the nearest ancestor's distribution; uniform if no ancestor
    /// has one.
    LightOctree Build(size_t groups, const AddValues &addValues);

    /// Number of leaves, including empty ones.
    size_t LeafCount() const { return tree_.leaves_; }
    /// Number of points per node, indexed by CellOctree::Cell::node. Valid before and after Build.
    std::vector<uint32_t> PointsPerNode() const {
        std::vector<uint32_t> counts;
        counts.reserve(rangeOf_.size());
        for (const Range &r : rangeOf_) counts.push_back(r.end - r.begin);
        return counts;
    }

  private:
    struct Range {
        uint32_t begin = 0, end = 0;
    };
    void Subdivide(uint32_t node, Range range, int bit);

    LightOctree tree_;
    std::vector<glm::uvec3> quantized_;  ///< per original point
    std::vector<uint32_t> order_;        ///< original indices, grouped by cell
    size_t splitAbove_ = 0;
    std::vector<Range> rangeOf_;      ///< per node
    std::vector<uint8_t> isLeaf_;     ///< per node
    std::vector<uint32_t> parentOf_;  ///< per node; top cells: none
};

}  // namespace ext
