#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "pbrt/lights/light_table.h"
#include "pbrt/lightsamplers/light_sampler.h"

namespace pbrt {

/// A node of the tree: a LightSphere and the link to what is below, in 32 bytes. Directions and cosines are rounded so
/// that the cone only grows.
class alignas(32) LightBvhNode {
  public:
    LightBvhNode() = default;
    /// `link`: leaf: index of the light; else index of the pair of children. Below 2^30.
    LightBvhNode(const LightBounds &bounds, bool isLeaf, uint32_t link);

    bool IsLeaf() const { return (link_ & kLeaf) != 0; }
    uint32_t Link() const { return link_ & kLinkMask; }
    LightSphere Sphere() const;

  private:
    friend struct LightBvhPair;
    static constexpr uint32_t kLeaf = 1u << 31, kTwoSided = 1u << 30, kLinkMask = kTwoSided - 1;
    Point3 center_{};
    Float radius_ = 0;
    Float phi_ = 0;
    uint16_t axis_[2] = {};         ///< octahedral
    uint16_t cosO_ = 0, cosE_ = 0;  ///< [-1, 1]
    uint32_t link_ = 0;
};
static_assert(sizeof(LightBvhNode) == 32);

/// Both children of an interior node: what one step of a walk looks at, in one cache line.
struct alignas(64) LightBvhPair {
    LightBvhNode child[2];
    /// child[i].Sphere().Importance(p, n), both at once. The same bits for the same arguments wherever it is called.
    void Importances(const Point3 &p, const Normal3 &n, Float out[2]) const;
};

/// Binary tree over the bounded lights, one light per leaf, split by the surface area orientation heuristic
/// (Conty and Kulla 2018, section 4) in 12 buckets per axis.
class LightBvh {
  public:
    static constexpr int kMaxDepth = 62;

    LightBvh() = default;
    explicit LightBvh(std::span<const LightCandidate> candidates);

    bool IsEmpty() const { return !hasRoot_; }
    const LightBvhNode &Root() const { return root_; }
    const LightBvhPair &Pair(uint32_t i) const { return pairs_[i]; }
    /// The path from the root to a candidate: bit d says which child is taken at depth d. NotInTree for candidates that
    /// the tree does not hold.
    static constexpr uint64_t NotInTree = ~uint64_t(0);
    uint64_t Trail(uint32_t candidate) const { return trails_[candidate]; }

    /// The interface for WalkDown (weighted_choice.h); importances are for the shading normal.
    using Node = const LightBvhNode *;
    struct Level {
        static constexpr uint32_t count = 2;
        const LightBvhPair *pair;
        Float weights[2];
        Float sum;
        Float WeightAt(uint32_t i) const { return weights[i]; }
        Node At(uint32_t i) const { return &pair->child[i]; }
    };
    static bool IsLeaf(Node node) { return node->IsLeaf(); }
    void WeighBelow(Node node, const LightQuery &query, Level *level) const {
        level->pair = &pairs_[node->Link()];
        level->pair->Importances(query.p, query.ns, level->weights);
        level->sum = level->weights[0] + level->weights[1];
    }

    size_t PairCount() const { return pairs_.size(); }
    int Depth() const { return depth_; }
    size_t Bytes() const { return pairs_.capacity() * sizeof(LightBvhPair) + trails_.capacity() * sizeof(uint64_t); }

  private:
    struct Item {
        LightBounds bounds;
        Point3 centroid;
        uint32_t light;
    };
    LightBvhNode Build(std::span<Item> items, uint64_t trail, int depth, LightBounds *bounds);

    LightBvhNode root_;
    bool hasRoot_ = false;
    int depth_ = 0;
    std::vector<LightBvhPair> pairs_;
    std::vector<uint64_t> trails_;
};

}  // namespace pbrt
