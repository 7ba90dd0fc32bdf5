#pragma once
#include <span>
#include <vector>

#include "ext/lightgroups/emitter.h"
#include "pbrt/lightsamplers/weighted_choice.h"

namespace ext {

/// Binary tree over emitters ("lights") with addressable nodes. A *cut* is a list of nodes that covers every light
/// exactly once. G of a node (EmitterPacket) is that of its lights' bounding sphere with their total intensity; it is
/// positive wherever G of one of them is.
///
/// Nodes are in preorder, so ascending nodes cover ascending light *positions*. Far lights have no location: up to
/// kFarNodes nodes after all others hold them and belong to every cut.
class LightTree {
  public:
    static constexpr size_t kFarNodes = 16;
    static constexpr uint32_t kNowhere = ~0u;

    LightTree() = default;
    /// Deterministic for any number of threads.
    explicit LightTree(std::span<const Emitter> emitters);

    size_t NodeCount() const { return ranges_.size(); }
    size_t FarNodeCount() const { return ranges_.size() - nearNodes_; }
    size_t LightCount() const { return order_.size(); }  ///< excludes lights that never contribute
    /// Positions of a node's lights.
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
    Float Intensity(uint32_t node) const {
        return node < nearNodes_ ? rows_[node].field[EmitterRow::kIntensity] : Float(0);
    }
    /// Nodes without a parent: the root of all near lights, then the far nodes. The shortest cut.
    std::span<const uint32_t> Roots() const { return roots_; }
    /// Cut of up to kBaseNodes near nodes and all far ones, for regions without learned data: splits nodes with maximum
    /// intensity times radius first.
    static constexpr size_t kBaseNodes = 48;
    std::span<const uint32_t> BaseCut() const { return base_; }

    /// Writes G of the nodes (ascending) to out[0, nodes.size()) and returns the sum.
    Float Evaluate(const LightQuery &query, std::span<const uint32_t> nodes, std::span<Float> out) const;
    /// Samples a light below a node, level by level by G: its probability given the node, and its G as `unoccluded`.
    /// Empty if no light there can contribute.
    std::optional<SampledLight> SampleWithin(uint32_t node, const LightQuery &query, Float u) const;
    /// Probability that SampleWithin selects the light at a position in the node's range.
    Float PMFWithin(uint32_t node, const LightQuery &query, uint32_t position) const;
    /// Index in a cut (ascending) of the node that holds a position.
    size_t FindInCut(std::span<const uint32_t> cut, uint32_t position) const;

    bool IsCut(std::span<const uint32_t> nodes) const;  ///< true if the nodes form a cut, ascending

    /// WalkDown interface (weighted_choice.h): up to eight nodes, in order, that cover an inner node.
    static constexpr int kLanes = EmitterPacket::kLanes;
    using Node = uint32_t;
    struct Level {
        uint32_t nodes[kLanes];
        Float g[kLanes];
        uint32_t count = 0;
        Float sum = 0;
        Float WeightAt(uint32_t i) const { return g[i]; }
        Node At(uint32_t i) const { return nodes[i]; }
        WeightedChoice<double, Float> Choose(double target) const {
            return ChooseByWeight<double>(count, target, [&](uint32_t i) { return g[i]; });
        }
    };
    bool IsLeaf(Node node) const { return !HasChildren(node); }
    void WeighBelow(Node node, const LightQuery &query, Level *level) const;

    size_t Bytes() const;

  private:
    class Builder;
    const Emitter &FarAt(uint32_t position) const { return far_[position + far_.size() - order_.size()]; }
    Float EvaluateFarNode(uint32_t node, const LightQuery &query) const;

    std::vector<Range> ranges_;     ///< per node
    std::vector<EmitterRow> rows_;  ///< per near node
    uint32_t nearNodes_ = 0;
    std::vector<Emitter> far_;  ///< positions LightCount() - far_.size() and up
    std::vector<uint32_t> order_, position_, roots_, base_;
};

}  // namespace ext
