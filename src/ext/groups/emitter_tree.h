#pragma once
#include <span>
#include <vector>

#include "ext/groups/emitter.h"

namespace ext {

/// A wide tree over emitters: every node has up to 32 children, chosen among in proportion to G (EmitterPacket), so a
/// choice among n emitters looks at 32 log_32 n of them. Children are made by splitting, again and again, the one whose
/// emitters differ most in place and direction (weighted by intensity): near a curved emitter the sides that face away
/// are told apart at the first level, which a binary tree of bounds learns only near its leaves.
class EmitterTree {
  public:
    EmitterTree() = default;
    explicit EmitterTree(std::span<const Emitter> emitters);

    /// An emitter (`light` is its index) and its probability; none if no emitter can contribute.
    std::optional<SampledLight> Sample(const LightQuery &query, Float u) const;
    Float PMF(const LightQuery &query, uint32_t emitter) const;

    int Depth() const { return depth_; }
    size_t NodeCount() const { return nodes_.size(); }
    size_t Bytes() const;

  private:
    static constexpr size_t kWidth = 32;
    static constexpr uint32_t kLeaf = 0x80000000u;
    struct Node {
        uint32_t firstPacket = 0, firstChild = 0, count = 0;
        uint32_t parent = 0, slot = 0;  ///< of the parent's children
        uint32_t farCount = 0;  ///< root only
    };
    uint32_t Build(std::span<uint32_t> items, std::span<const Emitter> emitters, uint32_t parent, uint32_t slot, int depth);
    /// G of a node's children; returns the sum.
    Float Evaluate(const Node &node, const LightQuery &query, Float *g) const;

    std::vector<Node> nodes_;
    std::vector<EmitterPacket> packets_;
    std::vector<uint32_t> children_;  ///< kLeaf | emitter, or node
    std::vector<Emitter> far_;        ///< the root's last children
    struct Place {
        uint32_t node = 0, slot = kLeaf;
    };
    std::vector<Place> places_;       ///< per emitter; slot kLeaf: not in the tree
    int depth_ = 0;
};

}  // namespace ext
