#pragma once
#include <functional>
#include <vector>

#include "ext/octree/light_octree.h"

namespace ext {

/// Builds a LightOctree from points (paper, section 4.1): a 4x4x4 grid, split while a cell holds more than 4N/T points;
/// a leaf's distribution is proportional to the mean, over its points, of a vector with one value per group.
class LightOctreeBuilder {
  public:
    /// `leafTarget`: the paper's T.
    LightOctreeBuilder(const Bounds3 &bounds, std::vector<Point3> points, int leafTarget);

    /// Adds the values of point `index` (position in the constructor's list) to `sum`. Called in parallel for points of
    /// different leaves, in a fixed order within a leaf.
    using AddValues = std::function<void(uint32_t index, std::span<double> sum)>;
    /// Leaves without points, and leaves where all values are 0, share the distribution of their nearest ancestor that
    /// has one; if there is none at all, every group gets the same share.
    LightOctree Build(size_t groups, const AddValues &addValues);

    /// The number of leaves of the tree, with and without points.
    size_t LeafCount() const { return tree_.leaves_; }
    /// The number of points in each node, indexed by CellOctree::Cell::node. Valid before and after Build.
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
