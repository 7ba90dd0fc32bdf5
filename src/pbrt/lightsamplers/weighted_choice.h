#pragma once
#include <algorithm>
#include <optional>

#include "pbrt/lightsamplers/light_sampler.h"

namespace pbrt {

/// One of several things, chosen with probability weight / sum of the weights.
template <class Sum, class Weight>
struct WeightedChoice {
    uint32_t index = 0;
    Weight weight = 0;
    Sum before = 0;  ///< sum of the weights before it

    explicit operator bool() const { return weight > 0; }
};

/// Chooses one of `count` things by a scan over their weights. `target`: a uniform number times the sum of the weights;
/// weightAt(i): the weight of thing i. The weights are added up in the precision of Sum. If rounding makes their sum
/// less than `target`, the last positive weight is chosen. Weight 0: nothing is chosen, as no weight is positive.
/// (No std::optional: it would be copied through memory, in the middle of every choice.)
template <class Sum, class WeightAt>
[[gnu::always_inline]] inline auto ChooseByWeight(size_t count, Sum target, WeightAt &&weightAt, Sum before = 0) {
    using Choice = WeightedChoice<Sum, decltype(weightAt(0u))>;
    Choice chosen;
    for (uint32_t i = 0; i < count; ++i) {
        const auto weight = weightAt(i);
        if (!(weight > 0)) continue;
        chosen = Choice{i, weight, before};
        before += static_cast<Sum>(weight);
        if (target < before) break;
    }
    return chosen;
}

/// ChooseByWeight for two. It looks results up in tables instead of branching, because processors cannot predict which
/// of the two is chosen.
template <class Sum, class Weight>
[[gnu::always_inline]] inline WeightedChoice<Sum, Weight> ChooseOfTwo(Sum target, const Weight *weights) {
    const Sum before[2] = {0, static_cast<Sum>(weights[0])};
    const uint32_t index = static_cast<uint32_t>(weights[1] > 0) & static_cast<uint32_t>(!(target < before[1]));
    return {index, weights[index], before[index]};
}

/// Where a walk down a tree over lights ends: at a leaf (the tree knows what it holds), and the probability of that.
template <class Node>
struct WalkEnd {
    Node node{};
    Float pmf = 1;
    double rest = 0;   ///< a fresh uniform number
    Float weight = 0;  ///< of the last choice; 0 if there was none
};

/// Walks down from `node` and chooses at every level among the nodes below by their weights. A tree has
///
///   using Node = ...;                           names a node; a small value
///   struct Level;                               what is known of the nodes below, kept from one level to the next:
///       Float sum;  Float WeightAt(i) const;  Node At(i) const;
///       WeightedChoice<double, Float> Choose(double target) const;   as ChooseByWeight; weight 0: nothing
///   bool IsLeaf(Node) const;
///   void WeighBelow(Node, const LightQuery &, Level *) const;
///
/// The result is empty if the walk comes to a node below which no weight is positive.
template <class Tree>
std::optional<WalkEnd<typename Tree::Node>> WalkDown(const Tree &tree, typename Tree::Node node,
                                                     const LightQuery &query, double u) {
    WalkEnd<typename Tree::Node> end{node, 1, u, 0};
    typename Tree::Level level;
    while (!tree.IsLeaf(end.node)) {
        tree.WeighBelow(end.node, query, &level);
        const double target = end.rest * static_cast<double>(level.sum);
        const WeightedChoice<double, Float> chosen = level.Choose(target);
        if (!(chosen.weight > 0)) return {};
        end.weight = chosen.weight;
        end.pmf *= chosen.weight / level.sum;
        end.rest = std::clamp((target - chosen.before) / static_cast<double>(chosen.weight), 0.0, 0x1.fffffffffffffp-1);
        end.node = level.At(chosen.index);
    }
    return end;
}

/// The probability that WalkDown from `*node` takes a given way: `next(node, level)` returns the index in `level` of
/// the node that the way goes to. `*node` becomes the leaf. The result equals the pmf of WalkDown to the bit.
template <class Tree, class Next>
Float WalkProbability(const Tree &tree, typename Tree::Node *node, const LightQuery &query, Next &&next) {
    Float pmf = 1;
    typename Tree::Level level;
    while (!tree.IsLeaf(*node)) {
        tree.WeighBelow(*node, query, &level);
        const uint32_t i = next(*node, level);
        const Float weight = level.WeightAt(i);
        if (!(weight > 0)) return 0;
        pmf *= weight / level.sum;
        *node = level.At(i);
    }
    return pmf;
}

}  // namespace pbrt
