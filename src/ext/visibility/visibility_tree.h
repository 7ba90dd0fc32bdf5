#pragma once
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "ext/visibility/cell_octree.h"

namespace ext {

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
    template <class Archive>
    void Visit(Archive &archive) {
        archive(cells_);
        archive.Structure(offset_);
        archive.Structure(nodes_);
        archive(codes_, leaves_, depth_);
    }
    /// Empty if valid, else the error. A tree without rows is valid.
    std::optional<std::string> Validate() const;

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

}  // namespace ext
