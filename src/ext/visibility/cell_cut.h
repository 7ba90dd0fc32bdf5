#pragma once
#include <span>
#include <vector>

#include "ext/lightgroups/light_tree.h"

namespace ext {

/// Sums over the shadow rays to one light in a cell.
struct ShadowRaySums {
    uint32_t light = 0;            ///< or, where there is a light tree, its position there
    double wm = 0, w = 0, w2 = 0;  ///< sums of w m, w, w^2; m: the learned moment, found / G or its square

    ShadowRaySums &operator+=(const ShadowRaySums &o) {
        wm += o.wm;
        w += o.w;
        w2 += o.w2;
        return *this;
    }
};

/// The learned moments of one cell of the octree for the nodes of the light tree: its top, down to a cut.
///
/// Estimate: a node's moment is its moment in the parent cell times a ratio, found over expected in this cell's shadow
/// rays, which pseudo-rays pull towards the ratio of the node's parent in the light tree. So records of one light count
/// for its neighbours in the light tree too, and lights that no shadow ray met keep the moments of the parent cell.
/// (The whole box expects 1 of every light.) Cut: the nodes that keep sum_n share_n sqrt(moment_n) low, the square root
/// of the second moment of a choice among them. It starts as the finest cut, in which the pair of siblings whose
/// joining costs least is joined, again and again.
class CellCut {
  public:
    struct Settings {
        double shrinkage = 4;      ///< pseudo-rays
        bool secondMoment = true;  ///< moments are squares of factors; false: they are the factors
        size_t nodes = 48;         ///< in a cut, far ones not counted
    };
    CellCut() = default;
    /// `sums`: by rising position; `weight`: sum of all their w; `above`: that of the parent cell, or null.
    CellCut(const LightTree &lights, std::span<const ShadowRaySums> sums, double weight, const CellCut *above,
            const Settings &settings);

    std::span<const uint32_t> Nodes() const { return nodes_; }   ///< of the cut, rising
    std::span<const float> Factors() const { return factors_; }  ///< one for each node of the cut

  private:
    struct Known {
        uint32_t node = 0, next = 0;  ///< `next`: index in known_ behind the node's subtree
        float moment = 0, share = 0;
    };
    struct Merger;
    bool IsInner(size_t i) const { return known_[i].next != i + 1; }
    std::vector<Known> known_;  ///< what child cells inherit, in preorder
    std::vector<uint32_t> nodes_;
    std::vector<float> factors_;
};

}  // namespace ext
