#include "ext/lightgroups/light_tree.h"

#include <algorithm>
#include <queue>

#include "pbrt/core/parallel.h"

namespace ext {
namespace {

/// Each child has at least 1 / kMinPart of its node's lights, which keeps the depth logarithmic.
constexpr uint32_t kMinPart = 8;

/// Split index of items sorted along `axis` that minimizes the summed weighted spread of both sides.
uint32_t BestSplit(std::span<const EmitterItem> items, size_t axis) {
    double weight = 0, sum = 0;
    for (const EmitterItem &item : items) {
        weight += double(item.weight);
        sum += double(item.weight * item.feature[axis]);
    }
    const auto count = uint32_t(items.size()), minCount = std::max(1u, count / kMinPart);
    uint32_t best = count / 2;
    double largest = -1, left = 0, leftSum = 0;
    for (uint32_t i = 0; i + minCount < count; ++i) {
        left += double(items[i].weight);
        leftSum += double(items[i].weight * items[i].feature[axis]);
        if (i + 1 < minCount || !(left > 0) || !(weight > left)) continue;
        // Total spread is constant: maximizing it between the sides minimizes it within them.
        const double rest = sum - leftSum, between = leftSum * leftSum / left + rest * rest / (weight - left);
        if (between > largest) {
            largest = between;
            best = i + 1;
        }
    }
    return best;
}

}  // namespace

class LightTree::Builder {
  public:
    Builder(LightTree &tree, std::span<const Emitter> emitters, std::vector<EmitterItem> items)
        : tree_(tree), emitters_(emitters), items_(std::move(items)), spread_(2 * items_.size(), 0) {
        Add(0, 0, uint32_t(items_.size()));
        for (uint32_t i = 0; i < items_.size(); ++i) tree_.order_[i] = items_[i].emitter;
    }
    /// Per node: bounding sphere radius times total intensity.
    std::span<const Float> Spread() const { return spread_; }

  private:
    Emitter Add(uint32_t node, uint32_t begin, uint32_t end) {
        tree_.ranges_[node] = {begin, end};
        Emitter whole;
        if (end - begin == 1) {
            whole = emitters_[items_[begin].emitter];
        } else {
            const uint32_t middle = Split(begin, end);
            Emitter first, second;
            auto addFirst = [&] { first = Add(node + 1, begin, middle); };
            auto addSecond = [&] { second = Add(node + 2 * (middle - begin), middle, end); };
            if (end - begin >= kManyEmitters) {
                ParallelInvoke(addFirst, addSecond);
            } else {
                addFirst();
                addSecond();
            }
            whole = Union(first, second);
        }
        const EmitterRow &row = tree_.rows_[node] = EmitterRow(whole);
        spread_[node] = std::sqrt(row.field[EmitterRow::kRadius2]) * row.field[EmitterRow::kIntensity];
        return whole;
    }

    uint32_t Split(uint32_t begin, uint32_t end) {
        const std::span<EmitterItem> items(items_.data() + begin, end - begin);
        FindFeatures(items, emitters_);
        const size_t axis = WidestAxis(items).axis;
        if (items.size() >= kManyEmitters) {
            const size_t middle = items.size() / 2;
            std::nth_element(items.begin(), items.begin() + middle, items.end(), LessAlong{axis});
            return begin + uint32_t(middle);
        }
        std::sort(items.begin(), items.end(), LessAlong{axis});
        return begin + BestSplit(items, axis);
    }

    LightTree &tree_;
    std::span<const Emitter> emitters_;
    std::vector<EmitterItem> items_;
    std::vector<Float> spread_;
};

LightTree::LightTree(std::span<const Emitter> emitters) : position_(emitters.size(), kNowhere) {
    std::vector<EmitterItem> items;
    std::vector<uint32_t> far;
    for (uint32_t i = 0; i < emitters.size(); ++i) {
        if (emitters[i].isFar) far.push_back(i);
        else if (emitters[i].bounds) items.push_back({i, emitters[i].intensity, {}});
    }
    const auto near = uint32_t(items.size());
    nearNodes_ = near > 0 ? 2 * near - 1 : 0;
    ranges_.resize(nearNodes_);
    rows_.resize(nearNodes_);
    order_.resize(near);
    if (near > 0) {
        const Builder builder(*this, emitters, std::move(items));
        roots_.push_back(0);
        std::priority_queue<std::pair<Float, uint32_t>> open;
        auto add = [&](uint32_t node) {
            if (HasChildren(node)) open.push({builder.Spread()[node], node});
            else base_.push_back(node);
        };
        add(0);
        while (!open.empty() && base_.size() + open.size() < kBaseNodes) {
            const uint32_t node = open.top().second;
            open.pop();
            add(First(node));
            add(Second(node));
        }
        for (; !open.empty(); open.pop()) base_.push_back(open.top().second);
        std::sort(base_.begin(), base_.end());
    }
    const size_t farNodes = std::min(far.size(), kFarNodes);
    for (size_t n = 0; n < farNodes; ++n) {
        const auto first = uint32_t(n * far.size() / farNodes), last = uint32_t((n + 1) * far.size() / farNodes);
        roots_.push_back(uint32_t(ranges_.size()));
        base_.push_back(roots_.back());
        ranges_.push_back({near + first, near + last});
    }
    for (uint32_t light : far) {
        far_.push_back(emitters[light]);
        order_.push_back(light);
    }
    for (uint32_t i = 0; i < order_.size(); ++i) position_[order_[i]] = i;
}

Float LightTree::EvaluateFarNode(uint32_t node, const LightQuery &query) const {
    Float sum = 0;
    for (uint32_t i = ranges_[node].begin; i < ranges_[node].end; ++i) sum += EvaluateFar(FarAt(i), query);
    return sum;
}

Float LightTree::Evaluate(const LightQuery &query, std::span<const uint32_t> nodes, std::span<Float> out) const {
    size_t near = nodes.size();
    while (near > 0 && nodes[near - 1] >= nearNodes_) --near;
    Float sum = 0;
    for (size_t begin = 0; begin < near; begin += kLanes) {
        const size_t count = std::min<size_t>(kLanes, near - begin);
        EmitterPacket gathered;
        Gather(rows_.data(), nodes.data() + begin, count, &gathered);
        Float g[kLanes];
        sum += EmitterPacket::EvaluateAll(&gathered, 1, query, g);
        std::copy(g, g + count, out.begin() + begin);
    }
    for (size_t i = near; i < nodes.size(); ++i) sum += out[i] = EvaluateFarNode(nodes[i], query);
    return sum;
}

void LightTree::WeighBelow(Node node, const LightQuery &query, Level *level) const {
    uint32_t *nodes = level->nodes;
    nodes[0] = node;
    level->count = 1;
    for (int round = 0; round < 3; ++round) {
        uint32_t next[kLanes];
        uint32_t nextCount = 0;
        for (uint32_t i = 0; i < level->count; ++i) {
            if (!HasChildren(nodes[i])) {
                next[nextCount++] = nodes[i];
                continue;
            }
            next[nextCount++] = First(nodes[i]);
            next[nextCount++] = Second(nodes[i]);
        }
        std::copy(next, next + nextCount, nodes);
        level->count = nextCount;
    }
    level->sum = Evaluate(query, {nodes, level->count}, level->g);
}

std::optional<SampledLight> LightTree::SampleWithin(uint32_t node, const LightQuery &query, Float u) const {
    const auto end = WalkDown(*this, node, query, double(u));
    if (!end) return {};
    const Range range = ranges_[end->node];
    if (range.Size() == 1) return SampledLight{LightId(order_[range.begin]), end->pmf, end->weight};
    const Float sum = EvaluateFarNode(end->node, query);
    const auto chosen = ChooseByWeight<Float>(range.Size(), Float(end->rest) * sum,
                                              [&](uint32_t i) { return EvaluateFar(FarAt(range.begin + i), query); });
    if (!chosen) return {};
    return SampledLight{LightId(order_[range.begin + chosen.index]), end->pmf * (chosen.weight / sum), chosen.weight};
}

Float LightTree::PMFWithin(uint32_t node, const LightQuery &query, uint32_t position) const {
    const Float pmf = WalkProbability(*this, &node, query, [&](Node, const Level &level) {
        return uint32_t(FindInCut({level.nodes, level.count}, position));
    });
    if (!(pmf > 0) || IsLight(node)) return pmf;
    const Float value = EvaluateFar(FarAt(position), query);
    return value > 0 ? pmf * (value / EvaluateFarNode(node, query)) : Float(0);
}

bool LightTree::IsCut(std::span<const uint32_t> nodes) const {
    uint32_t position = 0;
    for (uint32_t node : nodes) {
        if (node >= NodeCount() || At(node).begin != position) return false;
        position = At(node).end;
    }
    return position == LightCount();
}

size_t LightTree::FindInCut(std::span<const uint32_t> cut, uint32_t position) const {
    auto after = std::upper_bound(cut.begin(), cut.end(), position,
                                  [&](uint32_t p, uint32_t node) { return p < ranges_[node].begin; });
    return after - cut.begin() - 1;
}

size_t LightTree::Bytes() const {
    return ranges_.capacity() * sizeof(Range) + rows_.capacity() * sizeof(EmitterRow) +
           far_.capacity() * sizeof(Emitter) +
           (order_.capacity() + position_.capacity() + roots_.capacity() + base_.capacity()) * sizeof(uint32_t);
}

}  // namespace ext
