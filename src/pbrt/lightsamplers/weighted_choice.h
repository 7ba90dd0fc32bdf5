#pragma once
#include <algorithm>
#include <optional>

#include "pbrt/lightsamplers/light_sampler.h"

namespace pbrt {

/// An item selected with probability weight / sum of weights.
template <class Sum, class Weight>
struct WeightedChoice {
    uint32_t index = 0;
    Weight weight = 0;
    Sum before = 0;  ///< sum of the preceding weights

    explicit operator bool() const { return weight > 0; }
};

/// Selects one of `count` items by linear search. `target`: a uniform number times the sum of weights; weightAt(i):
/// weight of item i. Weights are summed in the precision of Sum. If rounding leaves the sum below `target`, the last
/// positive weight is selected. Weight 0: nothing selected, as no weight is positive. (Not std::optional, which would
/// be copied through memory in every selection.)
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

/// ChooseByWeight for two items. Branch-free table look-ups, as the outcome is unpredictable.
template <class Sum, class Weight>
[[gnu::always_inline]] inline WeightedChoice<Sum, Weight> ChooseOfTwo(Sum target, const Weight *weights) {
    const Sum before[2] = {0, static_cast<Sum>(weights[0])};
    const uint32_t index = uint32_t(weights[1] > 0) & uint32_t(!(target < before[1]));
    return {index, weights[index], before[index]};
}

/// Leaf reached by a traversal of a light tree, with its probability.
template <class Node>
struct WalkEnd {
    Node node{};
    Float pmf = 1;
    double rest = 0;   ///< a fresh uniform number
    Float weight = 0;  ///< of the last selection; 0 if there was none
};

/// Traverses a tree from `node`, selecting a child at every level by weight. A tree has
///
///   using Node = ...;                           node handle; a small value
///   struct Level;                               data of the child nodes, reused between levels:
///       Float sum;  Float WeightAt(i) const;  Node At(i) const;
///       WeightedChoice<double, Float> Choose(double target) const;   as ChooseByWeight; weight 0: nothing
///   bool IsLeaf(Node) const;
///   void WeighBelow(Node, const LightQuery &, Level *) const;
///
/// Returns empty at a node whose children all have weight 0.
template <class Tree>
std::optional<WalkEnd<typename Tree::Node>> WalkDown(const Tree &tree, typename Tree::Node node,
                                                     const LightQuery &query, double u) {
    WalkEnd<typename Tree::Node> end{node, 1, u, 0};
    typename Tree::Level level;
    while (!tree.IsLeaf(end.node)) {
        tree.WeighBelow(end.node, query, &level);
        const double target = end.rest * double(level.sum);
        const WeightedChoice<double, Float> chosen = level.Choose(target);
        if (!(chosen.weight > 0)) return {};
        end.weight = chosen.weight;
        end.pmf *= chosen.weight / level.sum;
        end.rest = std::clamp((target - chosen.before) / double(chosen.weight), 0.0, 0x1.fffffffffffffp-1);
        end.node = level.At(chosen.index);
    }
    return end;
}

/// Probability that WalkDown from `*node` takes a given path: `next(node, level)` returns the index in `level` of the
/// next node. `*node` becomes the leaf. Bit-identical to the pmf of WalkDown.
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
