#pragma once
#include <span>
#include <vector>

#include "ext/groups/light_tree.h"

namespace ext {

/// Sums over a cell's tries of one light.
struct TrySums {
    uint32_t light = 0;            ///< or, where there is a light tree, its position there
    double wm = 0, w = 0, w2 = 0;  ///< of w m (m: the moment that is learned, of found / G), w, w^2

    TrySums &operator+=(const TrySums &o) {
        wm += o.wm;
        w += o.w;
        w2 += o.w2;
        return *this;
    }
};

/// What a cell of the octree knows about the nodes of the light tree: the tree's top, down to a cut.
///
/// Estimate: of every node how the cell compares with its parent in the octree, found over expected, pulled by
/// pseudo-tries towards the same of the node above it in the light tree. So what a cell learns of one lamp in a room it
/// thinks of the neighbours too, and what it has not met it takes from the cell above. (The whole box expects 1 of
/// every light.) Cut: the nodes that keep sum_n share_n sqrt(moment_n) low, the square root of the second moment of a
/// choice among them; of the finest cut the pair of siblings that costs least is joined, again and again.
class CellCut {
  public:
    struct Settings {
        double shrinkage = 4;      ///< pseudo-tries
        bool secondMoment = true;  ///< moments are squares of factors
        size_t nodes = 48;         ///< of a cut, far ones not counted
    };
    CellCut() = default;
    /// `sums`: by rising position; `weight`: sum of all their w; `above`: of the cell's parent, or null.
    CellCut(const LightTree &lights, std::span<const TrySums> sums, double weight, const CellCut *above,
            const Settings &settings);

    std::span<const uint32_t> Nodes() const { return nodes_; }   ///< of the cut, rising
    std::span<const float> Factors() const { return factors_; }  ///< of them

  private:
    struct Known {
        uint32_t node = 0, next = 0;  ///< `next`: behind the node's own in known_; children follow their parent
        float moment = 0, share = 0;
    };
    struct Merger;
    bool IsInner(size_t i) const { return known_[i].next != i + 1; }
    std::vector<Known> known_;  ///< in preorder, without what children need not inherit
    std::vector<uint32_t> nodes_;
    std::vector<float> factors_;
};

}  // namespace ext
