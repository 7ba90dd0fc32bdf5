#pragma once
#include <span>
#include <vector>

#include "ext/groups/emitter.h"

namespace ext {

/// A binary tree over emitters (lights, for short) whose nodes can be named one by one: a *cut* is a list of nodes that
/// holds every light exactly once. A node stands for all lights below it: G of a node (EmitterPacket) is that of a
/// sphere around them with all their intensity, and positive wherever that of one of them is.
///
/// Nodes are in preorder, so that names in rising order are lights in rising order of *position*. Far lights have no
/// place: they are up to kFarNodes more nodes behind, and part of every cut.
class LightTree {
  public:
    static constexpr size_t kFarNodes = 16;
    static constexpr uint32_t kNowhere = ~0u;

    LightTree() = default;
    /// The same tree for any number of threads.
    explicit LightTree(std::span<const Emitter> emitters);

    size_t NodeCount() const { return ranges_.size(); }
    size_t FarNodeCount() const { return ranges_.size() - nearNodes_; }
    size_t LightCount() const { return order_.size(); }  ///< without those that never contribute
    /// Lights of a node, by position.
    struct Range {
        uint32_t begin = 0, end = 0;
        uint32_t Size() const { return end - begin; }
        bool operator==(const Range &o) const = default;
    };
    Range At(uint32_t node) const { return ranges_[node]; }
    uint32_t LightAt(uint32_t position) const { return order_[position]; }
    uint32_t PositionOf(uint32_t light) const { return position_[light]; }  ///< kNowhere: never contributes
    bool IsLight(uint32_t node) const { return ranges_[node].Size() == 1; }
    bool HasChildren(uint32_t node) const { return node < nearNodes_ && !IsLight(node); }
    uint32_t First(uint32_t node) const { return node + 1; }
    uint32_t Second(uint32_t node) const { return node + 2 * ranges_[node + 1].Size(); }
    Float Intensity(uint32_t node) const { return node < nearNodes_ ? rows_[node].field[kIntensity] : Float(0); }
    /// Nodes without a parent, in order: all near lights together, then the far ones. The shortest cut.
    std::span<const uint32_t> Roots() const { return roots_; }
    /// A cut of up to kBaseNodes nodes and the far ones, where nothing is known: what is strong and wide is divided.
    static constexpr size_t kBaseNodes = 48;
    std::span<const uint32_t> BaseCut() const { return base_; }

    /// G of nodes in rising order into out[0, nodes.size()); returns the sum.
    Float Evaluate(const LightQuery &query, std::span<const uint32_t> nodes, std::span<Float> out) const;
    /// A light below a node, chosen level by level by G, its probability given the node, and its G as `unoccluded`.
    /// None if no light there can contribute.
    std::optional<SampledLight> SampleWithin(uint32_t node, const LightQuery &query, Float u) const;
    /// Of a light at a position in the node's range.
    Float PMFWithin(uint32_t node, const LightQuery &query, uint32_t position) const;
    /// The node of a cut (rising) that holds a position, by its place in the cut.
    size_t FindInCut(std::span<const uint32_t> cut, uint32_t position) const;

    /// For WalkDown (weighted_choice.h): up to eight nodes, in order, that hold the lights of a node with children.
    static constexpr int kLanes = EmitterPacket::kLanes;
    using Node = uint32_t;
    struct Level {
        uint32_t nodes[kLanes];
        Float g[kLanes];
        uint32_t count = 0;
        Float sum = 0;
        Float WeightAt(uint32_t i) const { return g[i]; }
        Node At(uint32_t i) const { return nodes[i]; }
    };
    bool IsLeaf(Node node) const { return !HasChildren(node); }
    void WeighBelow(Node node, const LightQuery &query, Level *level) const;

    size_t Bytes() const;

  private:
    static constexpr size_t kIntensity = 7;  ///< in EmitterRow
    class Builder;
    Float EvaluateFarNode(uint32_t node, const LightQuery &query) const;
    void ChooseBaseCut(std::span<const Float> spread);

    std::vector<Range> ranges_;     ///< per node
    std::vector<EmitterRow> rows_;  ///< per near node
    uint32_t nearNodes_ = 0;
    std::vector<Emitter> far_;  ///< at position LightCount() - far_.size() and after
    std::vector<uint32_t> order_, position_, roots_, base_;
};

}  // namespace ext
