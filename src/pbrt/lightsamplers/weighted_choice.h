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
};

/// The only scan over weights. `target`: a uniform number times the sum of the weights; WeightAt(i) for i below
/// `count`. The weights are added up in the precision of Sum. What rounding leaves over goes to the last positive
/// weight; nothing is chosen if there is none.
template <class Sum, class WeightAt>
[[gnu::always_inline]] inline auto ChooseByWeight(size_t count, Sum target, WeightAt &&weightAt, Sum before = 0) {
    using Choice = WeightedChoice<Sum, decltype(weightAt(0u))>;
    std::optional<Choice> chosen;
    for (uint32_t i = 0; i < count; ++i) {
        const auto weight = weightAt(i);
        if (!(weight > 0)) continue;
        chosen = Choice{i, weight, before};
        before += static_cast<Sum>(weight);
        if (target < before) break;
    }
    return chosen;
}

/// Where a walk down a tree over lights ends: at a leaf (for the tree to say what that is), and how likely that was.
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
///   struct Level { uint32_t count; Float sum;  Float WeightAt(i) const;  Node At(i) const; };
///   bool IsLeaf(Node) const;
///   void WeighBelow(Node, const LightQuery &, Level *) const;   the nodes below, with their weights and the sum of
///   these
///
/// None if nothing below some node has a weight.
template <class Tree>
std::optional<WalkEnd<typename Tree::Node>> WalkDown(const Tree &tree, typename Tree::Node node,
                                                     const LightQuery &query, double u) {
    WalkEnd<typename Tree::Node> end{node, 1, u, 0};
    while (!tree.IsLeaf(end.node)) {
        typename Tree::Level level;
        tree.WeighBelow(end.node, query, &level);
        const double target = end.rest * static_cast<double>(level.sum);
        const auto chosen = ChooseByWeight<double>(level.count, target, [&](uint32_t i) { return level.WeightAt(i); });
        if (!chosen) return {};
        end.weight = chosen->weight;
        end.pmf *= chosen->weight / level.sum;
        end.rest =
            std::clamp((target - chosen->before) / static_cast<double>(chosen->weight), 0.0, 0x1.fffffffffffffp-1);
        end.node = level.At(chosen->index);
    }
    return end;
}

/// The probability that WalkDown from `*node` takes a certain way: `next(node, level)` says to which of the nodes below
/// it goes. `*node` becomes the leaf. Equal to WalkDown's to the bit.
template <class Tree, class Next>
Float WalkProbability(const Tree &tree, typename Tree::Node *node, const LightQuery &query, Next &&next) {
    Float pmf = 1;
    while (!tree.IsLeaf(*node)) {
        typename Tree::Level level;
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
