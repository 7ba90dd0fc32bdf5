#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "pbrt/lights/light_table.h"
#include "pbrt/lightsamplers/group_light_sampler.h"
#include "pbrt/lightsamplers/weighted_choice.h"

namespace pbrt {

/// Tree node in 32 bytes: a LightSphere and a link. Rounded so that the cone only grows, up to Importance's margin.
class alignas(32) LightBvhNode {
  public:
    LightBvhNode() = default;
    /// `link`: light index (leaf) or index of the pair of children. Below 2^30.
    LightBvhNode(const LightBounds &bounds, bool isLeaf, uint32_t link);

    static constexpr uint32_t kLeaf = 1u << 31;
    bool IsLeaf() const { return (link_ & kLeaf) != 0; }
    uint32_t Link() const { return link_ & kLinkMask; }
    uint32_t LinkAndKind() const { return link_ & ~kTwoSided; }
    void LinkTo(uint32_t link) { link_ = (link_ & ~kLinkMask) | link; }
    LightSphere Sphere() const;

  private:
    friend struct LightBvhBlock;
    static constexpr uint32_t kTwoSided = 1u << 30, kLinkMask = kTwoSided - 1;
    Point3 center_{};
    Float radius_ = 0;
    Float phi_ = 0;
    uint16_t axis_[2] = {};         ///< octahedral
    uint16_t cosO_ = 0, cosE_ = 0;  ///< [-1, 1]
    uint32_t link_ = 0;
};
static_assert(sizeof(LightBvhNode) == 32);

/// Children of several interior nodes as structure of arrays, with joint importance evaluation: a traversal often
/// continues to a pair in the same block.
struct alignas(64) LightBvhBlock {
#ifdef __AVX512F__
    static constexpr uint32_t kPairs = 8;
#else
    static constexpr uint32_t kPairs = 4;
#endif
    static constexpr uint32_t kLanes = 2 * kPairs;

    void Set(uint32_t lane, const LightBvhNode &node);
    LightBvhNode Node(uint32_t lane) const;
    uint32_t LinkAndKind(uint32_t lane) const { return link[lane]; }
    /// Node(i).Sphere().Importance(p, n) of all nodes, 0 for unset lanes. Bit-identical for equal arguments, for all
    /// call sites and contents of other lanes.
    void Importances(const Point3 &p, const Normal3 &n, Float out[kLanes]) const;

  private:
    Float centerX[kLanes] = {}, centerY[kLanes] = {}, centerZ[kLanes] = {}, radius[kLanes] = {};
    Float phi[kLanes] = {};  ///< negative: two-sided
    uint16_t axisU[kLanes] = {}, axisV[kLanes] = {}, cosO[kLanes] = {}, cosE[kLanes] = {};
    uint32_t link[kLanes] = {};
};
static_assert(sizeof(LightBvhBlock) == LightBvhBlock::kLanes * sizeof(LightBvhNode));

/// Binary tree over the bounded lights, one per leaf. Splits use the surface area orientation heuristic (Conty and
/// Kulla 2018, section 4) with 12 buckets per axis. Selection is stock's; only the memory layout differs: a block holds
/// an interior node and its most powerful descendants.
class LightBvh {
  public:
    static constexpr int kMaxDepth = 62;

    LightBvh() = default;
    explicit LightBvh(std::span<const LightCandidate> candidates);

    bool IsEmpty() const { return !hasRoot_; }
    const LightBvhNode &Root() const { return root_; }
    LightBvhNode Child(const LightBvhNode &node, uint32_t which) const {
        const uint32_t lane = 2 * node.Link() + which;
        return blocks_[lane / LightBvhBlock::kLanes].Node(lane % LightBvhBlock::kLanes);
    }
    /// Path from the root to a candidate: bit d is the child at depth d. NotInTree for candidates not in the tree.
    static constexpr uint64_t NotInTree = ~uint64_t(0);
    uint64_t Trail(uint32_t candidate) const { return trails_[candidate]; }

    /// WalkDown interface (weighted_choice.h); importances use the shading normal.
    using Node = uint32_t;  ///< LightBvhNode::LinkAndKind
    static uint32_t Light(Node leaf) { return leaf & ~LightBvhNode::kLeaf; }
    struct Level {
        const LightBvhBlock *block = nullptr;  ///< block whose importances are cached
        uint32_t lane = 0;                     ///< of the first of the two children
        alignas(32) Float importances[LightBvhBlock::kLanes];
        Float sum;
        Float WeightAt(uint32_t i) const { return importances[lane + i]; }
        Node At(uint32_t i) const { return block->LinkAndKind(lane + i); }
        WeightedChoice<double, Float> Choose(double target) const { return ChooseOfTwo(target, importances + lane); }
    };
    static bool IsLeaf(Node node) { return (node & LightBvhNode::kLeaf) != 0; }
    void WeighBelow(Node node, const LightQuery &query, Level *level) const {
        const LightBvhBlock *block = &blocks_[node / LightBvhBlock::kPairs];
        if (level->block != block) {
            level->block = block;
            block->Importances(query.p, query.ns, level->importances);
        }
        level->lane = 2 * (node % LightBvhBlock::kPairs);
        level->sum = level->importances[level->lane] + level->importances[level->lane + 1];
    }

    size_t PairCount() const { return pairCount_; }
    int Depth() const { return depth_; }
    size_t Bytes() const { return blocks_.capacity() * sizeof(LightBvhBlock) + trails_.capacity() * sizeof(uint64_t); }

  private:
    struct Item {
        LightBounds bounds;
        Point3 centroid;
        uint32_t light;
    };
    struct Pair {
        LightBvhNode child[2];
    };
    class Packing;
    LightBvhNode Build(std::span<Item> items, uint64_t trail, int depth, LightBounds *bounds, std::vector<Pair> *pairs);

    LightBvhNode root_;
    bool hasRoot_ = false;
    int depth_ = 0;
    size_t pairCount_ = 0;
    std::vector<LightBvhBlock> blocks_;  ///< a node's link i: pair i % kPairs of block i / kPairs
    std::vector<uint64_t> trails_;
};

/// Traverses a light BVH, selecting children by their importance at the query point with the shading normal. Infinite
/// lights: see InfiniteShare.
class BVHLightSampler final : public GroupLightSampler {
  public:
    explicit BVHLightSampler(const LightGroups &groups);
    std::optional<ChosenGroup> ChooseGroup(const LightQuery &query, const void *weights, Float u) const override;
    Float GroupProbability(const LightQuery &query, const void *weights, uint32_t group) const override;
    void Report(nlohmann::ordered_json &json) const override;

    const LightBvh &Tree() const { return tree_; }

  private:
    /// False if the tree holds a single light whose importance at the query point is 0.
    bool Reaches(const LightQuery &query) const {
        return !tree_.Root().IsLeaf() || tree_.Root().Sphere().Importance(query.p, query.ns) > 0;
    }

    LightBvh tree_;
    InfiniteShare infinite_;
};

}  // namespace pbrt
