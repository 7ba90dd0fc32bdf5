#pragma once
#include <span>
#include <vector>

#include "ext/lightgroups/emitter.h"
#include "pbrt/lightsamplers/weighted_choice.h"

namespace ext {

/// Wide tree over emitters: every node has up to 32 children, selected in proportion to G (EmitterPacket). Selecting
/// among n emitters evaluates G about 32 log_32 n times. Children result from repeatedly splitting the cluster with
/// maximum spread in position and direction, weighted by intensity.
class EmitterTree {
  public:
    EmitterTree() = default;
    /// Deterministic for any number of threads.
    explicit EmitterTree(std::span<const Emitter> emitters);

    /// Samples an emitter (`light` is its index) with its probability; empty if no emitter can contribute.
    std::optional<SampledLight> Sample(const LightQuery &query, Float u) const;
    Float PMF(const LightQuery &query, uint32_t emitter) const;

    /// WalkDown interface (weighted_choice.h): a node, or kLeaf | emitter. Far lights are the root's last children.
    static constexpr size_t kWidth = 32;
    static constexpr uint32_t kLeaf = 0x80000000u;
    using Node = uint32_t;
    struct Level {
        static constexpr size_t kLanes = EmitterPacket::kLanes;
        alignas(32) Float g[kWidth];  ///< whole packets; 0 in lanes of other nodes
        Float packetSums[kWidth / kLanes];
        uint32_t packets = 0, firstLane = 0;
        const uint32_t *children;
        const EmitterTree *tree;
        const LightQuery *query;
        uint32_t near = 0;  ///< children, excluding far lights
        uint32_t far = 0;
        Float sum = 0;
        Float WeightAt(uint32_t i) const {
            return i < near ? g[firstLane + i] : EvaluateFar(tree->far_[i - near].emitter, *query);
        }
        Node At(uint32_t i) const { return i < near ? children[i] : kLeaf | tree->far_[i - near].index; }
        WeightedChoice<double, Float> Choose(double target) const;
    };
    static bool IsLeaf(Node node) { return (node & kLeaf) != 0; }
    void WeighBelow(Node node, const LightQuery &query, Level *level) const;

    int Depth() const { return depth_; }
    size_t Bytes() const;

  private:
    struct Branch {
        uint32_t firstPacket = 0, firstChild = 0, parent = 0;
        uint8_t firstLane = 0;  ///< in the first packet; small nodes share packets
        uint8_t count = 0;      ///< children, excluding far lights
        uint8_t slot = 0;       ///< index among the parent's children
    };
    struct Place {
        uint32_t node = 0, slot = kLeaf;
    };
    struct Cluster;
    struct Subtree;

    std::vector<Branch> nodes_;
    std::vector<EmitterPacket> packets_;
    std::vector<uint32_t> children_;  ///< kLeaf | emitter, or node
    std::vector<FarEmitter> far_;     ///< further children of the root, after the others
    std::vector<Place> places_;       ///< per emitter; slot kLeaf: not in the tree
    int depth_ = 0;
};

}  // namespace ext
