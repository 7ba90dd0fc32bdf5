#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "pbrt/core/state_io.h"
#include "pbrt/math/bounds.h"

namespace ext {
using namespace pbrt;

/// Binary space partition: nodes are split at the median of their points, across the longest side. The builder numbers
/// the leaves.
class PointTree {
  public:
    static constexpr uint32_t kLeaf = 3;
    struct Node {
        Float split = 0;
        uint32_t axis = kLeaf;
        uint32_t below = 0;  ///< first of two consecutive children, after the node; in a leaf: its number

        bool IsLeaf() const { return axis == kLeaf; }
    };

    bool IsEmpty() const { return nodes_.empty(); }
    const std::vector<Node> &Nodes() const { return nodes_; }
    size_t Bytes() const { return nodes_.size() * sizeof(Node); }
    /// Number of the leaf that contains p, below a root. The tree must not be empty.
    uint32_t LeafOf(const Point3 &p, uint32_t root = 0) const {
        const Node *const nodes = nodes_.data(), *node = nodes + root;
        while (!node->IsLeaf()) node = nodes + (node->below + (Component(p, node->axis) < node->split ? 0u : 1u));
        return node->below;
    }

    /// Resets to this many trees: nodes 0 to `roots` - 1.
    void Begin(size_t roots) { nodes_.assign(roots, {}); }
    void MakeLeaf(size_t node, size_t number) { nodes_[node] = {0, kLeaf, uint32_t(number)}; }
    /// Splits a node and reorders its points [begin, end), those of the first child first. Returns the start of the
    /// second child's points; `begin` if the node stays a leaf because all points coincide.
    template <class Iterator, class PointOf>
    Iterator Divide(size_t node, Iterator begin, Iterator end, PointOf &&pointOf) {
        Bounds3 bounds;
        for (Iterator i = begin; i != end; ++i) bounds = Union(bounds, pointOf(*i));
        const Vector3 size = bounds.high - bounds.low;
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        const Iterator middle = begin + (end - begin) / 2;
        std::nth_element(begin, middle, end,
                         [&](const auto &a, const auto &b) { return pointOf(a)[axis] < pointOf(b)[axis]; });
        Float split = pointOf(*middle)[axis];
        // Half of the points or more may lie in the lowest plane, as on a floor; they form the first half then.
        if (split == bounds.low[axis]) {
            split = std::numeric_limits<Float>::infinity();
            for (Iterator i = begin; i != end; ++i)
                if (pointOf(*i)[axis] > bounds.low[axis]) split = std::min(split, pointOf(*i)[axis]);
        }
        const Iterator second = std::partition(begin, end, [&](const auto &e) { return pointOf(e)[axis] < split; });
        if (second == end) return begin;
        nodes_[node] = {split, uint32_t(axis), uint32_t(nodes_.size())};
        nodes_.resize(nodes_.size() + 2);
        return second;
    }

    void Visit(auto &archive) { archive.Structure(nodes_); }
    /// Empty, or why LeafOf would not terminate or return a number of `leaves` or more. Unreachable nodes are allowed.
    std::optional<std::string> ValidateFor(size_t roots, size_t leaves) const {
        if (nodes_.empty()) return {};
        if (nodes_.size() < roots || (nodes_.size() - roots) % 2 != 0) return "a point tree is incomplete";
        std::vector<bool> isChild((nodes_.size() - roots) / 2, false);
        for (size_t i = 0; i < nodes_.size(); ++i) {
            const Node &node = nodes_[i];
            if (node.axis > kLeaf) return "a node of a point tree has an invalid axis";
            if (node.IsLeaf()) {
                if (node.below >= leaves) return "a leaf of a point tree has an invalid number";
                continue;
            }
            const size_t pair = (size_t{node.below} - roots) / 2;
            if (node.below <= i || node.below < roots || (node.below - roots) % 2 != 0 || pair >= isChild.size() ||
                isChild[pair] || std::isnan(node.split))
                return "nodes of a point tree share children or have none";
            isChild[pair] = true;
        }
        return {};
    }

  private:
    std::vector<Node> nodes_;
};

}  // namespace ext
