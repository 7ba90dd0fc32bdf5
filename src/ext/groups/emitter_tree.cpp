#include "ext/groups/emitter_tree.h"

#include <algorithm>
#include <array>

namespace ext {

namespace {

/// Place and direction as one vector: places relative to the cloud's size, directions weighted so that opposite ones are
/// as different as opposite ends.
using Feature = std::array<Float, 6>;
Feature FeatureOf(const Emitter &e, const Point3 &center, Float invSize) {
    Vector3 place = (e.bounds->Centroid() - center) * invSize;
    Float direction = e.isArea && !e.bounds->twoSided ? Float(0.35) * (1 + e.bounds->cosTheta_o) / 2 : 0;
    Vector3 w = e.bounds->w * direction;
    return {place.x, place.y, place.z, w.x, w.y, w.z};
}

struct Cluster {
    size_t begin = 0, end = 0;
    double spread = 0;  ///< sum of weighted squared distances from the mean, along the widest axis
    int axis = 0;
};

}  // namespace

EmitterTree::EmitterTree(std::span<const Emitter> emitters) : places_(emitters.size()) {
    std::vector<uint32_t> items, far;
    for (uint32_t i = 0; i < emitters.size(); ++i) {
        if (emitters[i].isFar) far.push_back(i);
        else if (emitters[i].bounds) items.push_back(i);
    }
    if (items.empty() && far.empty()) return;
    // The root leaves room for far lights; if there are very many of them it is simply wider.
    Build(items, emitters, 0, 0, 0);
    Node &root = nodes_[0];
    // Far lights follow the root's other children, which were made last and so stand at the end of the array.
    root.farCount = static_cast<uint32_t>(far.size());
    for (uint32_t i = 0; i < far.size(); ++i) {
        far_.push_back(emitters[far[i]]);
        places_[far[i]] = {0, root.count + i};
        children_.push_back(kLeaf | far[i]);
    }
}

uint32_t EmitterTree::Build(std::span<uint32_t> items, std::span<const Emitter> emitters, uint32_t parent, uint32_t slot, int depth) {
    const auto index = static_cast<uint32_t>(nodes_.size());
    nodes_.emplace_back();
    nodes_[index].parent = parent;
    nodes_[index].slot = slot;
    depth_ = std::max(depth_, depth + 1);

    Bounds3 cloud;
    for (uint32_t i : items) cloud = Union(cloud, emitters[i].bounds->Centroid());
    const Point3 center = items.empty() ? Point3(0) : cloud.Center();
    const Float size = items.empty() ? Float(1) : Length(cloud.Diagonal());
    const Float invSize = size > 0 ? 1 / size : 1;

    auto measure = [&](Cluster *c) {
        double mean[6] = {}, square[6] = {}, weight = 0;
        for (size_t i = c->begin; i < c->end; ++i) {
            const Emitter &e = emitters[items[i]];
            Feature f = FeatureOf(e, center, invSize);
            auto w = static_cast<double>(e.intensity);
            weight += w;
            for (size_t a = 0; a < 6; ++a) {
                mean[a] += w * static_cast<double>(f[a]);
                square[a] += w * static_cast<double>(f[a] * f[a]);
            }
        }
        c->spread = c->end - c->begin > 1 ? 0 : -1;
        for (int a = 0; a < 6 && c->spread >= 0; ++a) {
            double v = weight > 0 ? square[a] - mean[a] * mean[a] / weight : 0;
            if (v > c->spread) {
                c->spread = v;
                c->axis = a;
            }
        }
    };
    std::vector<Cluster> clusters;
    if (!items.empty()) {
        clusters.push_back({0, items.size()});
        measure(&clusters[0]);
    }
    while (!clusters.empty() && clusters.size() < kWidth) {
        auto widest = std::max_element(clusters.begin(), clusters.end(), [](const Cluster &a, const Cluster &b) { return a.spread < b.spread; });
        if (widest->spread < 0) break;
        // Half of the emitters to each side.
        Cluster left = *widest, right = *widest;
        left.end = right.begin = (widest->begin + widest->end) / 2;
        const auto axis = static_cast<size_t>(widest->axis);
        auto less = [&](uint32_t a, uint32_t b) {
            Float fa = FeatureOf(emitters[a], center, invSize)[axis], fb = FeatureOf(emitters[b], center, invSize)[axis];
            return fa != fb ? fa < fb : a < b;
        };
        auto at = [&](size_t i) { return items.begin() + static_cast<std::ptrdiff_t>(i); };
        std::nth_element(at(left.begin), at(left.end), at(right.end), less);
        measure(&left);
        measure(&right);
        *widest = left;
        clusters.push_back(right);
    }

    std::vector<uint32_t> children;
    std::vector<EmitterPacket> packets((clusters.size() + EmitterPacket::kLanes - 1) / EmitterPacket::kLanes);
    for (uint32_t c = 0; c < clusters.size(); ++c) {
        Emitter all;
        for (size_t i = clusters[c].begin; i < clusters[c].end; ++i) all = Union(all, emitters[items[i]]);
        packets[c / EmitterPacket::kLanes].Set(c % EmitterPacket::kLanes, all);
        if (clusters[c].end - clusters[c].begin == 1) {
            children.push_back(kLeaf | items[clusters[c].begin]);
            places_[items[clusters[c].begin]] = {index, c};
        } else {
            children.push_back(Build(items.subspan(clusters[c].begin, clusters[c].end - clusters[c].begin), emitters, index, c, depth + 1));
        }
    }
    Node &node = nodes_[index];
    node.count = static_cast<uint32_t>(children.size());
    node.firstPacket = static_cast<uint32_t>(packets_.size());
    node.firstChild = static_cast<uint32_t>(children_.size());
    packets_.insert(packets_.end(), packets.begin(), packets.end());
    children_.insert(children_.end(), children.begin(), children.end());
    return index;
}

Float EmitterTree::Evaluate(const Node &node, const LightQuery &query, Float *g) const {
    Float sum = 0;
    for (size_t i = 0; i < node.count; i += EmitterPacket::kLanes)
        packets_[node.firstPacket + i / EmitterPacket::kLanes].Evaluate(query, g + i);
    for (size_t i = 0; i < node.count; ++i) sum += g[i];
    return sum;
}

std::optional<SampledLight> EmitterTree::Sample(const LightQuery &query, Float u) const {
    if (nodes_.empty()) return {};
    auto rest = static_cast<double>(u);
    Float pmf = 1;
    for (uint32_t n = 0;;) {
        const Node &node = nodes_[n];
        Float g[kWidth];
        Float sum = Evaluate(node, query, g);
        for (uint32_t i = 0; i < node.farCount; ++i) sum += EvaluateFar(far_[i], query);
        if (!(sum > 0)) return {};
        double target = rest * static_cast<double>(sum), before = 0;
        std::optional<uint32_t> chosen;
        double chosenBefore = 0;
        Float chosenG = 0;
        for (uint32_t i = 0; i < node.count + node.farCount; ++i) {
            Float value = i < node.count ? g[i] : EvaluateFar(far_[i - node.count], query);
            if (!(value > 0)) continue;
            chosen = i;
            chosenG = value;
            chosenBefore = before;
            before += static_cast<double>(value);
            if (target < before) break;
        }
        pmf *= chosenG / sum;
        const uint32_t child = children_[node.firstChild + *chosen];
        if (child & kLeaf) return SampledLight{LightId(child & ~kLeaf), pmf};
        rest = std::clamp((target - chosenBefore) / static_cast<double>(chosenG), 0.0, 0x1.fffffffffffffp-1);
        n = child;
    }
}

Float EmitterTree::PMF(const LightQuery &query, uint32_t emitter) const {
    Place place = places_[emitter];
    if (place.slot == kLeaf) return 0;
    // From the root down, so that the product is Sample's to the last bit.
    std::array<Place, 16> way;
    size_t length = 0;
    for (;; place = {nodes_[place.node].parent, nodes_[place.node].slot}) {
        way[length++] = place;
        if (place.node == 0) break;
    }
    Float pmf = 1;
    while (length-- > 0) {
        const Node &node = nodes_[way[length].node];
        Float g[kWidth];
        Float sum = Evaluate(node, query, g);
        for (uint32_t i = 0; i < node.farCount; ++i) sum += EvaluateFar(far_[i], query);
        const uint32_t slot = way[length].slot;
        Float value = slot < node.count ? g[slot] : EvaluateFar(far_[slot - node.count], query);
        if (!(value > 0)) return 0;
        pmf *= value / sum;
    }
    return pmf;
}

size_t EmitterTree::Bytes() const {
    return nodes_.capacity() * sizeof(Node) + packets_.capacity() * sizeof(EmitterPacket) + children_.capacity() * sizeof(uint32_t) +
           far_.capacity() * sizeof(Emitter) + places_.capacity() * sizeof(Place);
}

}  // namespace ext
