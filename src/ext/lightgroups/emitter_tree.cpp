#include "ext/lightgroups/emitter_tree.h"

#include <algorithm>
#include <array>

#include "pbrt/core/parallel.h"

namespace ext {

struct EmitterTree::Cluster {
    size_t begin = 0, end = 0;
    double spread = 0;  ///< along the widest axis; negative: a single emitter
    size_t axis = 0;

    void Measure(std::span<const EmitterItem> items) {
        spread = -1;
        if (end - begin <= 1) return;
        const WidestAxis widest(items.subspan(begin, end - begin));
        spread = widest.spread;
        axis = widest.axis;
    }
};

/// A tree or subtree, without its packets.
struct EmitterTree::Subtree {
    std::vector<Branch> nodes;    ///< [0] is the root
    std::vector<Emitter> unions;  ///< per node, the union of its emitters (not set for the root)
    std::vector<uint32_t> children;
    int depth = 0;

    /// Adds a node over these items and its subtree; returns the node's index.
    uint32_t Add(std::span<EmitterItem> items, std::span<const Emitter> emitters, const Emitter &whole, int level) {
        const auto index = uint32_t(nodes.size()), firstChild = uint32_t(children.size());
        depth = std::max(depth, level + 1);
        const std::vector<Cluster> clusters = Divide(items, emitters);
        nodes.push_back({.firstChild = firstChild, .count = uint8_t(clusters.size())});
        unions.push_back(whole);
        children.resize(firstChild + clusters.size());

        const bool asTasks = items.size() >= kManyEmitters;
        std::vector<Subtree> parts(asTasks ? clusters.size() : 0);
        auto build = [&](size_t c) {
            std::span<EmitterItem> below = items.subspan(clusters[c].begin, clusters[c].end - clusters[c].begin);
            if (below.size() == 1) return kLeaf | below[0].emitter;
            Emitter all;
            for (const EmitterItem &item : below) all = Union(all, emitters[item.emitter]);
            return (asTasks ? parts[c] : *this).Add(below, emitters, all, level + 1);
        };
        if (asTasks) ParallelForEach(clusters.size(), [&](int64_t c) { children[firstChild + c] = build(c); });
        for (size_t c = 0; c < clusters.size(); ++c) {
            // Not one expression: Add may reallocate `children`.
            uint32_t child = asTasks ? children[firstChild + c] : build(c);
            if (asTasks && !(child & kLeaf)) child = Append(parts[c]);
            children[firstChild + c] = child;
            if (child & kLeaf) continue;
            nodes[child].parent = index;
            nodes[child].slot = uint8_t(c);
        }
        return index;
    }

    uint32_t Append(const Subtree &part) {
        const auto firstNode = uint32_t(nodes.size()), firstChild = uint32_t(children.size());
        for (Branch node : part.nodes) {
            node.parent += firstNode;
            node.firstChild += firstChild;
            nodes.push_back(node);
        }
        for (uint32_t child : part.children) children.push_back(child & kLeaf ? child : child + firstNode);
        unions.insert(unions.end(), part.unions.begin(), part.unions.end());
        depth = std::max(depth, part.depth);
        return firstNode;
    }

    static std::vector<Cluster> Divide(std::span<EmitterItem> items, std::span<const Emitter> emitters) {
        FindFeatures(items, emitters);
        std::vector<Cluster> clusters;
        if (items.empty()) return clusters;
        clusters.reserve(kWidth);
        clusters.push_back({0, items.size()});
        clusters[0].Measure(items);
        while (clusters.size() < kWidth) {
            const auto widest = std::ranges::max_element(clusters, {}, &Cluster::spread);
            if (widest->spread < 0) break;
            Cluster left = *widest, right = *widest;
            left.end = right.begin = (widest->begin + widest->end) / 2;
            auto at = [&](size_t i) { return items.begin() + i; };
            std::nth_element(at(left.begin), at(left.end), at(right.end), LessAlong{widest->axis});
            left.Measure(items);
            right.Measure(items);
            *widest = left;
            clusters.push_back(right);
        }
        return clusters;
    }
};

EmitterTree::EmitterTree(std::span<const Emitter> emitters) : places_(emitters.size()) {
    std::vector<EmitterItem> items;
    for (uint32_t i = 0; i < emitters.size(); ++i) {
        if (emitters[i].isFar) far_.push_back({i, emitters[i]});
        else if (emitters[i].bounds) items.push_back({i, emitters[i].intensity, {}});
    }
    if (items.empty() && far_.empty()) return;
    Subtree tree;
    tree.Add(items, emitters, {}, 0);
    nodes_ = std::move(tree.nodes);
    children_ = std::move(tree.children);
    depth_ = tree.depth;
    nodes_.shrink_to_fit();
    children_.shrink_to_fit();
    far_.shrink_to_fit();
    constexpr size_t kLanes = EmitterPacket::kLanes;
    size_t begin = 0;  // first free lane
    for (Branch &node : nodes_) {
        if (begin % kLanes + node.count > kLanes) begin = (begin + kLanes - 1) / kLanes * kLanes;
        node.firstPacket = uint32_t(begin / kLanes);
        node.firstLane = uint8_t(begin % kLanes);
        begin += node.count;
    }
    packets_.resize((begin + kLanes - 1) / kLanes);
    for (uint32_t n = 0; n < nodes_.size(); ++n)
        for (uint32_t c = 0; c < nodes_[n].count; ++c) {
            const Branch &node = nodes_[n];
            const uint32_t child = children_[node.firstChild + c];
            const size_t lane = node.firstLane + c;
            packets_[node.firstPacket + lane / kLanes].Set(
                lane % kLanes, child & kLeaf ? emitters[child & ~kLeaf] : tree.unions[child]);
            if (child & kLeaf) places_[child & ~kLeaf] = {n, c};
        }
    for (uint32_t i = 0; i < far_.size(); ++i) places_[far_[i].index] = {0, nodes_[0].count + i};
}

void EmitterTree::WeighBelow(Node n, const LightQuery &query, Level *level) const {
    const Branch &node = nodes_[n];
    constexpr uint32_t kLanes = Level::kLanes;
    const uint32_t end = node.firstLane + node.count;
    level->packets = (end + kLanes - 1) / kLanes;
    EmitterPacket::EvaluateAll(packets_.data() + node.firstPacket, level->packets, query, level->g);
    for (uint32_t i = 0; i < node.firstLane; ++i) level->g[i] = 0;
    for (uint32_t i = end; i < level->packets * kLanes; ++i) level->g[i] = 0;
    level->sum = 0;
    for (uint32_t p = 0; p < level->packets; ++p)
        level->sum += level->packetSums[p] = EmitterPacket::Sum(level->g + p * kLanes);
    level->firstLane = node.firstLane;
    level->children = children_.data() + node.firstChild;
    level->tree = this;
    level->query = &query;
    level->near = node.count;
    level->far = n == 0 ? uint32_t(far_.size()) : 0;
    for (uint32_t i = 0; i < level->far; ++i) level->sum += EvaluateFar(far_[i].emitter, query);
}

/// Selects the packet, then the lane.
WeightedChoice<double, Float> EmitterTree::Level::Choose(double target) const {
    double before = 0;
    for (uint32_t p = 0; p < packets; ++p) {
        const double after = before + double(packetSums[p]);
        if (target < after) {
            const Float *lanes = g + p * kLanes;
            auto chosen = ChooseByWeight<double>(
                kLanes, target, [&](uint32_t i) { return lanes[i]; }, before);
            chosen.index += p * uint32_t(kLanes) - firstLane;
            return chosen;
        }
        before = after;
    }
    if (auto chosen = ChooseByWeight<double>(
            far, target, [&](uint32_t i) { return WeightAt(near + i); }, before)) {
        chosen.index += near;
        return chosen;
    }
    // Reached only by rounding: the last child of positive weight.
    return ChooseByWeight<double>(near, std::numeric_limits<double>::infinity(),
                                  [&](uint32_t i) { return WeightAt(i); });
}

std::optional<SampledLight> EmitterTree::Sample(const LightQuery &query, Float u) const {
    if (nodes_.empty()) return {};
    const auto end = WalkDown(*this, Node(0), query, double(u));
    if (!end) return {};
    return SampledLight{LightId(end->node & ~kLeaf), end->pmf};
}

Float EmitterTree::PMF(const LightQuery &query, uint32_t emitter) const {
    Place place = places_[emitter];
    if (place.slot == kLeaf) return 0;
    std::array<uint32_t, 32> slots;  // bottom-up; a child has at most half (rounded up) of its node's emitters
    size_t depth = 0;
    for (;; place = {nodes_[place.node].parent, nodes_[place.node].slot}) {
        slots[depth++] = place.slot;
        if (place.node == 0) break;
    }
    Node node = 0;
    return WalkProbability(*this, &node, query, [&](Node, const Level &) { return slots[--depth]; });
}

size_t EmitterTree::Bytes() const {
    return nodes_.capacity() * sizeof(Branch) + packets_.capacity() * sizeof(EmitterPacket) +
           children_.capacity() * sizeof(uint32_t) + far_.capacity() * sizeof(FarEmitter) +
           places_.capacity() * sizeof(Place);
}

}  // namespace ext
