#pragma once
#include <span>
#include <vector>

#include "ext/visibility/visibility_tree.h"

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
    std::optional<std::string> Validate() const;
    size_t GroupCount() const { return groups_; }

  private:
    friend class LightOctreeBuilder;
    CellOctree cells_;
    std::vector<Float> cdf_;
    size_t groups_ = 0;
    size_t leaves_ = 0;
    int depth_ = 0;
};

}  // namespace ext
