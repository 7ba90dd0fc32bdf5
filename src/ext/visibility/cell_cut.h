#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "ext/lightgroups/light_tree.h"

namespace ext {

/// Shadow ray from record x to light (group) l, of the prepass or the render.
struct ShadowRay {
    uint32_t light = 0;
    Float share = 0;   ///< G_l(x) / sum of G over all lights; if lights are drawn, the sum is estimated from the
                       ///< record's shadow rays
    Float weight = 0;  ///< share over the expected number of draws of the light; a record's weights sum to 1
    Float ratio = 0;   ///< measured contribution / G_l(x)
};

/// Limit of the lights that the shadow rays of a cell tested but never reached, as one may be a sun behind a wall: the
/// mean, over the cell's records, of the scale (at most 1) that makes their weight equal to that of the other lights.
class UnreachedLimit {
  public:
    /// Adds a record. `lightOf(ray)`: pair of the factor of the light's weight, and whether the limit is for the light.
    void Add(std::span<const ShadowRay> record, auto &&lightOf) {
        double unreached = 0, rest = 0;
        for (const ShadowRay &ray : record) {
            const auto [factor, isUnreached] = lightOf(ray);
            (isUnreached ? unreached : rest) += double(ray.weight) * factor;
        }
        if (!(unreached > 0 && rest > 0)) return;
        sum_ += std::min(rest / unreached, 1.0);
        ++count_;
    }
    /// Factor, at most 1, of the weights of the unreached lights.
    double Scale() const { return count_ > 0 ? sum_ / count_ : 1; }

  private:
    double sum_ = 0;
    int count_ = 0;
};

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
/// for every light. Nodes that shadow rays of the cell tested without reaching a light get at most about as much weight
/// as the others, as one may be a sun behind a wall.
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
    /// `forEachRecord(visit)` calls visit with the shadow rays of each record of the cell.
    CellCut(const LightTree &lights, std::span<const ShadowRaySums> sums, double weight, const CellCut *above,
            const Settings &settings, auto &&forEachRecord) {
        Merger merger{lights, sums, weight, above, settings};
        merger.SumUp();
        const double all = merger.w.back() > 0 ? merger.wm.back() / merger.w.back() : 0, prior = all > 0 ? all : 1;
        size_t begin = 0, indexAbove = 0;
        const std::span<const uint32_t> roots = lights.Roots();
        for (uint32_t root : roots) {
            const size_t end = merger.Find(begin, sums.size(), lights.At(root).end);
            if (above) {
                const NodeEstimate &estimate = above->estimates_[indexAbove];
                merger.Add(root, begin, end, indexAbove, double(estimate.moment), 1, double(estimate.share));
                indexAbove = estimate.next;
            } else {
                const double share = weight > 0 ? (merger.w[end] - merger.w[begin]) / weight : 1 / double(roots.size());
                merger.Add(root, begin, end, {}, 1, prior, share);
            }
            begin = end;
        }
        merger.LimitUnreached(forEachRecord);
        merger.SetKeys();
        const size_t far = lights.FarNodeCount();
        merger.JoinDownTo(kInherited * settings.nodes + far);
        merger.ForEach([&](const Merger::Item &item, bool) {
            estimates_.push_back({item.node, 0, float(item.moment), float(item.share)});
        });
        // Backwards: a node ends where its second child does.
        for (size_t i = estimates_.size(); i-- > 0;) {
            estimates_[i].next = uint32_t(i + 1);
            const bool inner = i + 1 < estimates_.size() && lights.HasChildren(estimates_[i].node) &&
                               estimates_[i + 1].node == lights.First(estimates_[i].node);
            if (inner) estimates_[i].next = estimates_[estimates_[i + 1].next].next;
        }
        merger.JoinDownTo(settings.nodes + far);
        merger.ForEach([&](const Merger::Item &item, bool inner) {
            if (inner) return;
            nodes_.push_back(item.node);
            factors_.push_back(float(merger.Factor(item)));
        });
    }

    std::span<const uint32_t> Nodes() const { return nodes_; }   ///< of the cut, ascending
    std::span<const float> Factors() const { return factors_; }  ///< one per node of the cut

  private:
    static constexpr size_t kInherited = 2;  ///< children of a cell inherit up to this many times the nodes of a cut
    /// Cost factor of a node of several lights, as selection below it is imperfect.
    static constexpr double kInnerCost = 1.1;
    /// Siblings are always merged below this fraction of the finest cut's cost.
    static constexpr double kNoCost = 1e-4;
    static constexpr double kNever = -std::numeric_limits<double>::infinity();
    /// Bounds of the ratio of a node's moment to the parent cell's.
    static constexpr double kMinRatio = 1e-4, kMaxRatio = 1e4;

    struct NodeEstimate {
        uint32_t node = 0, next = 0;  ///< `next`: index in estimates_ past the node's subtree
        float moment = 0, share = 0;
    };
    /// Estimates all nodes that the shadow rays or the parent cell distinguish, then merges.
    struct Merger {
        const LightTree &lights;
        std::span<const ShadowRaySums> sums;
        double weight;
        const CellCut *above;
        const Settings &settings;
        struct Item {
            uint32_t node = 0, next = 0, second = 0;  ///< `second`: item of the second child; 0: node of the cut
            double moment = 0, share = 0;
            double cost = 0;           ///< contribution of the node to the cost of a cut
            double key = 0;            ///< maximum merge cost at or below the node
            bool isUnreached = false;  ///< no shadow ray reached the node's lights
        };
        std::vector<Item> items = {};
        std::vector<double> w = {}, w2 = {}, wm = {},
                            expected = {};  ///< running sums, one more entry; `expected`: of wm, from the parent cell

        /// Index of the first of sums [begin, end) at or after a position; `end` if none.
        size_t Find(size_t begin, size_t end, uint32_t position) const {
            const auto some = sums.subspan(begin, end - begin);
            return begin + (std::ranges::lower_bound(some, position, {}, &ShadowRaySums::light) - some.begin());
        }
        void SumUp() {
            for (std::vector<double> *v : {&w, &w2, &wm, &expected}) v->assign(1, 0);
            size_t at = 0;  // index of the light in the parent cell
            for (const ShadowRaySums &s : sums) {
                if (above)
                    while (above->IsInner(at) || lights.At(above->estimates_[at].node).end <= s.light) ++at;
                w.push_back(w.back() + s.w);
                w2.push_back(w2.back() + s.w2);
                wm.push_back(wm.back() + s.wm);
                expected.push_back(expected.back() + s.w * (above ? double(above->estimates_[at].moment) : 1));
            }
        }

        /// Adds a node and its subtree. `indexAbove`: the node's index in the parent cell's estimates_; empty if that
        /// cell does not distinguish it, then `momentAbove` is the moment of its ancestor there. `ratioBefore`: the
        /// ratio of this cell's moment to the parent cell's, for the node's parent in the light tree. `shareBefore`:
        /// the expected share of the node.
        void Add(uint32_t node, size_t begin, size_t end, std::optional<size_t> indexAbove, double momentAbove,
                 double ratioBefore, double shareBefore) {
            const double sw = w[end] - w[begin], sw2 = w2[end] - w2[begin], se = expected[end] - expected[begin],
                         k = settings.shrinkage;
            const double rays = begin < end && sw2 > 0 && se > 0 ? sw * sw / sw2 : 0,
                         measured = rays > 0 ? (wm[end] - wm[begin]) / se : 0;
            const double ratio =
                rays + k > 0 ? std::clamp((rays * measured + k * ratioBefore) / (rays + k), kMinRatio, kMaxRatio)
                             : ratioBefore;
            Item item{.node = node, .isUnreached = begin < end && !(wm[end] > wm[begin])};
            item.moment = ratio * momentAbove;
            item.share = (sw + k * shareBefore) / std::max(weight + k, 1e-9);
            item.cost = CostOf(item);
            const auto index = uint32_t(items.size());
            items.push_back(item);
            const bool isSplitAbove = indexAbove && above->IsInner(*indexAbove);
            if (lights.HasChildren(node) && (begin < end || isSplitAbove)) {
                const uint32_t first = lights.First(node), second = lights.Second(node);
                const size_t middle = Find(begin, end, lights.At(second).begin);
                std::optional<size_t> a, b;
                double shareA = double(lights.Intensity(first)), shareB = double(lights.Intensity(second));
                double momentA = momentAbove, momentB = momentAbove;
                if (isSplitAbove) {
                    a = *indexAbove + 1;
                    b = above->estimates_[*a].next;
                    const NodeEstimate &one = above->estimates_[*a], &other = above->estimates_[*b];
                    momentA = double(one.moment);
                    momentB = double(other.moment);
                    shareA = double(one.share);
                    shareB = double(other.share);
                }
                const double total = shareA + shareB;
                shareA = total > 0 ? item.share * shareA / total : item.share / 2;
                Add(first, begin, middle, a, momentA, ratio, shareA);
                items[index].second = uint32_t(items.size());
                Add(second, middle, end, b, momentB, ratio, item.share - shareA);
            } else {
                ++nodes;
            }
            items[index].next = uint32_t(items.size());
        }
        /// Applies UnreachedLimit to all items, and sums up the cost of the finest cut.
        void LimitUnreached(auto &&forEachRecord) {
            std::vector<uint32_t> finest, begins;
            for (uint32_t i = 0; i < items.size(); ++i) {
                if (IsInner(i)) continue;
                finest.push_back(i);
                begins.push_back(lights.At(items[i].node).begin);
            }
            const auto lightOf = [&](const ShadowRay &ray) {
                const auto next = std::ranges::upper_bound(begins, lights.PositionOf(ray.light));
                const Item &item = items[finest[next - begins.begin() - 1]];
                return std::pair(Factor(item), item.isUnreached);
            };
            UnreachedLimit limit;
            forEachRecord([&](std::span<const ShadowRay> record) { limit.Add(record, lightOf); });
            const double scale = limit.Scale();
            for (Item &item : items) {
                if (!item.isUnreached) continue;
                item.moment *= settings.secondMoment ? scale * scale : scale;
                item.cost *= scale;
            }
            for (const uint32_t i : finest) total += items[i].cost;
        }
        /// Needs the costs of all items. Children follow their parents.
        void SetKeys() {
            for (size_t i = items.size(); i-- > 0;) {
                if (!IsInner(i)) continue;
                const Item &one = items[i + 1], &other = items[items[i].second];
                items[i].key = std::max({items[i].cost - one.cost - other.cost, IsInner(i + 1) ? one.key : kNever,
                                         other.second != 0 ? other.key : kNever});
            }
        }

        double Factor(const Item &item) const { return settings.secondMoment ? std::sqrt(item.moment) : item.moment; }
        double CostOf(const Item &item) const {
            return item.share * Factor(item) * (lights.IsLight(item.node) ? 1 : kInnerCost);
        }
        bool IsInner(size_t i) const { return items[i].second != 0; }

        size_t nodes = 0;                                     ///< of the cut
        double total = 0;                                     ///< cost of the finest cut
        std::vector<std::pair<double, uint32_t>> joins = {};  ///< keys and items
        /// Merges siblings in order of cost: all that are almost free, and more until the cut has at most `most` nodes.
        /// A node's key is at least the maximum key below it, so descendants are merged first.
        void JoinDownTo(size_t most) {
            joins.clear();
            size_t free = 0;
            for (uint32_t i = 0; i < items.size(); i = IsInner(i) ? i + 1 : items[i].next) {
                if (!IsInner(i)) continue;
                // For equal keys, deeper nodes come first.
                joins.push_back({items[i].key, ~i});
                free += items[i].key < kNoCost * total;
            }
            const size_t count = std::min(joins.size(), std::max(free, nodes > most ? nodes - most : 0));
            if (count < joins.size()) std::nth_element(joins.begin(), joins.begin() + count, joins.end());
            for (size_t k = 0; k < count; ++k) items[~joins[k].second].second = 0;
            nodes -= count;
        }
        /// Visits the remaining nodes in preorder.
        void ForEach(auto &&visit) const {
            for (uint32_t i = 0; i < items.size(); i = IsInner(i) ? i + 1 : items[i].next) visit(items[i], IsInner(i));
        }
    };
    bool IsInner(size_t i) const { return estimates_[i].next != i + 1; }
    std::vector<NodeEstimate> estimates_;  ///< inherited by child cells, in preorder
    std::vector<uint32_t> nodes_;
    std::vector<float> factors_;
};

}  // namespace ext
