#pragma once
#include <span>
#include <vector>

#include "ext/lightgroups/light_tree.h"

namespace ext {

struct ShadowRaySums {
    uint32_t light = 0;            ///< or its position in the light tree, if any
    double wm = 0, w = 0, w2 = 0;  ///< sums of w m, w, w^2; m: the learned moment, contribution / G or its square

    ShadowRaySums &operator+=(const ShadowRaySums &o) {
        wm += o.wm;
        w += o.w;
        w2 += o.w2;
        return *this;
    }
};

/// Learned moments of one octree cell for the nodes of the light tree, from its root down to a cut.
///
/// Estimate: a node's moment is its moment in the parent cell times the ratio of measured to expected moment in this
/// cell. Pseudo-rays shrink the ratio towards that of the node's parent in the light tree. So a light's records also
/// inform its neighbours in the light tree, and untested lights keep the parent cell's moments. The root cell expects 1
/// for every light.
///
/// Cut: minimizes sum_n share_n sqrt(moment_n), the square root of the second moment of a selection among the nodes.
/// From the finest cut, the sibling pair with the lowest merge cost is merged repeatedly.
class CellCut {
  public:
    struct Settings {
        double shrinkage = 4;      ///< pseudo-rays
        bool secondMoment = true;  ///< moments are squared factors; false: the factors
        size_t nodes = 48;         ///< per cut, excluding far ones
    };
    CellCut() = default;
    /// `sums`: sorted by position; `weight`: sum of all their w; `above`: the parent cell's cut, or null.
    CellCut(const LightTree &lights, std::span<const ShadowRaySums> sums, double weight, const CellCut *above,
            const Settings &settings);

    std::span<const uint32_t> Nodes() const { return nodes_; }   ///< of the cut, ascending
    std::span<const float> Factors() const { return factors_; }  ///< one per node of the cut

  private:
    struct Known {
        uint32_t node = 0, next = 0;  ///< `next`: index in known_ past the node's subtree
        float moment = 0, share = 0;
    };
    struct Merger;
    bool IsInner(size_t i) const { return known_[i].next != i + 1; }
    std::vector<Known> known_;  ///< inherited by child cells, in preorder
    std::vector<uint32_t> nodes_;
    std::vector<float> factors_;
};

}  // namespace ext
