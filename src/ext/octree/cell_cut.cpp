#include "ext/octree/cell_cut.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <queue>

namespace ext {

namespace {
/// Nodes that a cell's children inherit, times those of a cut.
constexpr size_t kInherited = 4;
/// A node that is no single light is chosen less well than its factor says.
constexpr double kInnerCost = 1.1;
/// Siblings are joined if that costs less than this part of the whole.
constexpr double kNoCost = 1e-4;
/// How much more or less than the cell above said.
constexpr double kLeastRatio = 1e-4, kMostRatio = 1e4;
}  // namespace

/// Estimates all nodes that the tries or the cell above tell apart, then joins.
struct CellCut::Merger {
    const LightTree &lights;
    std::span<const TrySums> sums;
    double weight;
    const CellCut *above;
    const Settings &settings;
    struct Item {
        uint32_t node = 0, parent = 0, next = 0, second = 0;  ///< `second`: its second child; 0: none, it is in the cut
        double moment = 0, share = 0, cost = 0;
    };
    std::vector<Item> items;
    std::vector<double> w, w2, wm, expected;  ///< running sums, one more entry; `expected`: of wm, by the cell above

    void SumUp() {
        for (std::vector<double> *v : {&w, &w2, &wm, &expected}) v->assign(1, 0);
        size_t known = 0;  // where the cell above holds the light
        for (const TrySums &s : sums) {
            if (above)
                while (above->IsInner(known) || lights.At(above->known_[known].node).end <= s.light) ++known;
            w.push_back(w.back() + s.w);
            w2.push_back(w2.back() + s.w2);
            wm.push_back(wm.back() + s.wm);
            expected.push_back(expected.back() + s.w * (above ? static_cast<double>(above->known_[known].moment) : 1));
        }
    }

    /// `knownAbove`: the node in the cell above; none if that does not tell it apart, then `momentAbove` is of a node that
    /// holds it. `ratioBefore`: how this cell compares with the one above, over the node's parent.
    void Add(uint32_t node, uint32_t parent, size_t begin, size_t end, std::optional<size_t> knownAbove, double momentAbove, double ratioBefore,
             double shareBefore) {
        const double sw = w[end] - w[begin], sw2 = w2[end] - w2[begin], se = expected[end] - expected[begin], k = settings.shrinkage;
        const double tries = begin < end && sw2 > 0 && se > 0 ? sw * sw / sw2 : 0, found = tries > 0 ? (wm[end] - wm[begin]) / se : 0;
        const double ratio = tries + k > 0 ? std::clamp((tries * found + k * ratioBefore) / (tries + k), kLeastRatio, kMostRatio) : ratioBefore;
        Item item{.node = node, .parent = parent};
        item.moment = ratio * momentAbove;
        item.share = (sw + k * shareBefore) / std::max(weight + k, 1e-9);
        const auto index = static_cast<uint32_t>(items.size());
        items.push_back(item);
        const bool toldApart = knownAbove && above->IsInner(*knownAbove);
        if (lights.HasChildren(node) && (begin < end || toldApart)) {
            const uint32_t first = lights.First(node), second = lights.Second(node), border = lights.At(second).begin;
            const auto middle = static_cast<size_t>(
                std::partition_point(sums.begin() + static_cast<std::ptrdiff_t>(begin), sums.begin() + static_cast<std::ptrdiff_t>(end),
                                     [&](const TrySums &s) { return s.light < border; }) - sums.begin());
            std::optional<size_t> a, b;
            double shareA = static_cast<double>(lights.Intensity(first)), shareB = static_cast<double>(lights.Intensity(second));
            double momentA = momentAbove, momentB = momentAbove;
            if (toldApart) {
                a = *knownAbove + 1;
                b = above->known_[*a].next;
                const Known &one = above->known_[*a], &other = above->known_[*b];
                momentA = static_cast<double>(one.moment);
                momentB = static_cast<double>(other.moment);
                shareA = static_cast<double>(one.share);
                shareB = static_cast<double>(other.share);
            }
            const double total = shareA + shareB;
            shareA = total > 0 ? item.share * shareA / total : item.share / 2;
            Add(first, index, begin, middle, a, momentA, ratio, shareA);
            items[index].second = static_cast<uint32_t>(items.size());
            Add(second, index, middle, end, b, momentB, ratio, item.share - shareA);
        }
        items[index].next = static_cast<uint32_t>(items.size());
    }

    double Factor(const Item &item) const { return settings.secondMoment ? std::sqrt(item.moment) : item.moment; }
    double CostOf(const Item &item) const {
        return item.share * Factor(item) * (lights.IsLight(item.node) ? 1 : kInnerCost);
    }
    bool IsInner(size_t i) const { return items[i].second != 0; }

    std::priority_queue<std::pair<double, uint32_t>, std::vector<std::pair<double, uint32_t>>, std::greater<>> queue;
    size_t nodes = 0;
    double total = 0;
    void Offer(uint32_t i) {
        const Item &item = items[i];
        if (IsInner(i + 1) || IsInner(item.second)) return;
        queue.push({item.cost - items[i + 1].cost - items[item.second].cost, i});
    }
    void BeginJoining() {
        for (uint32_t i = 0; i < items.size(); ++i) {
            items[i].cost = CostOf(items[i]);
            if (IsInner(i)) continue;
            total += items[i].cost;
            ++nodes;
        }
        for (uint32_t i = 0; i < items.size(); ++i)
            if (IsInner(i)) Offer(i);
    }
    void JoinDownTo(size_t most) {
        while (!queue.empty() && (nodes > most || queue.top().first < kNoCost * total)) {
            const auto [cost, i] = queue.top();
            queue.pop();
            items[i].second = 0;
            total += cost;
            --nodes;
            if (i != items[i].parent && IsInner(items[i].parent)) Offer(items[i].parent);
        }
    }
    /// In preorder, what is left.
    template <class Visit>
    void ForEach(Visit &&visit) const {
        for (uint32_t i = 0; i < items.size(); i = IsInner(i) ? i + 1 : items[i].next) visit(items[i], IsInner(i));
    }
};

CellCut::CellCut(const LightTree &lights, std::span<const TrySums> sums, double weight, const CellCut *above, const Settings &settings) {
    Merger merger{lights, sums, weight, above, settings, {}, {}, {}, {}, {}, {}};
    merger.SumUp();
    const double all = merger.w.back() > 0 ? merger.wm.back() / merger.w.back() : 0, prior = all > 0 ? all : 1;
    size_t begin = 0, knownAbove = 0;
    const std::span<const uint32_t> roots = lights.Roots();
    for (uint32_t root : roots) {
        const size_t end = static_cast<size_t>(std::partition_point(sums.begin() + static_cast<std::ptrdiff_t>(begin), sums.end(),
                                                                    [&](const TrySums &s) { return s.light < lights.At(root).end; }) - sums.begin());
        const auto self = static_cast<uint32_t>(merger.items.size());
        if (above) {
            const Known &known = above->known_[knownAbove];
            merger.Add(root, self, begin, end, knownAbove, static_cast<double>(known.moment), 1, static_cast<double>(known.share));
            knownAbove = known.next;
        } else {
            merger.Add(root, self, begin, end, {}, 1, prior, 1 / static_cast<double>(roots.size()));
        }
        begin = end;
    }
    const size_t far = lights.FarNodeCount();
    merger.BeginJoining();
    merger.JoinDownTo(kInherited * settings.nodes + far);
    merger.ForEach([&](const Merger::Item &item, bool) {
        known_.push_back({item.node, 0, static_cast<float>(item.moment), static_cast<float>(item.share)});
    });
    // From the back: a node ends where its second child does.
    for (size_t i = known_.size(); i-- > 0;) {
        known_[i].next = static_cast<uint32_t>(i + 1);
        const bool inner = i + 1 < known_.size() && lights.HasChildren(known_[i].node) && known_[i + 1].node == lights.First(known_[i].node);
        if (inner) known_[i].next = known_[known_[i + 1].next].next;
    }
    merger.JoinDownTo(settings.nodes + far);
    merger.ForEach([&](const Merger::Item &item, bool inner) {
        if (inner) return;
        nodes_.push_back(item.node);
        factors_.push_back(static_cast<float>(merger.Factor(item)));
    });
}

}  // namespace ext
