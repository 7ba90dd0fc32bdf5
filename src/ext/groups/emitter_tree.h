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
    /// The same tree for any number of threads.
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
        uint32_t firstPacket = 0, firstChild = 0, parent = 0;
        uint8_t firstLane = 0;  ///< in the first packet: small nodes share packets
        uint8_t count = 0;      ///< children, without far lights
        uint8_t slot = 0;       ///< among the parent's children
    };
    struct Place {
        uint32_t node = 0, slot = kLeaf;
    };
    struct Cluster;
    struct Part;
    struct Far {
        uint32_t index;
        Emitter emitter;
    };
    void MakePackets(std::span<const Emitter> emitters, std::span<const Emitter> wholes);
    /// G of a node's children; returns the sum, with far lights.
    struct Values {
        alignas(32) Float buffer[kWidth];
        const Float *g;
    };
    Float Evaluate(uint32_t node, const LightQuery &query, Values *values) const;
    uint32_t FarCount(uint32_t node) const { return node == 0 ? static_cast<uint32_t>(far_.size()) : 0; }

    std::vector<Node> nodes_;
    std::vector<EmitterPacket> packets_;
    std::vector<uint32_t> children_;  ///< kLeaf | emitter, or node
    std::vector<Far> far_;            ///< more children of the root, after the others
    std::vector<Place> places_;       ///< per emitter; slot kLeaf: not in the tree
    int depth_ = 0;
};

}  // namespace ext
