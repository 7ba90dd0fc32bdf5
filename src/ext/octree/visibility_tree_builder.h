#pragma once
#include <span>
#include <vector>

#include "ext/octree/structure_text.h"
#include "ext/octree/visibility_tree.h"

namespace ext {

/// One shadow ray of the prepass: light (group) l looked at from record x.
struct VisibilityTry {
    uint32_t light = 0;
    Float share = 0;   ///< G_l(x) / sum of G over all lights, that sum estimated from the record's tries if they are drawn
    Float weight = 0;  ///< share, divided by the number of times the light was to be drawn; a record's weights add up to 1
    Float floorPmf = 0;///< what the sampler's floor would give the light here
    Float ratio = 0;   ///< contribution found / G_l(x)
};

/// A point where light was looked for; its tries are consecutive.
struct VisibilityRecord {
    Point3 p{};
    uint32_t firstTry = 0, tryCount = 0;
};

struct VisibilityBuildSettings {
    int lightCount = 0;
    int largestFullRow = 64;    ///< rows name all lights up to this many; above, the `longestRow` that matter most
    int longestRow = 48;
    int records = 50;           ///< a leaf wants about this many
    Float shrinkage = 4;        ///< pseudo-tries of the parent's estimate
    Float pruneGain = 0.01f;    ///< a split must lower the held-out second moment by this share; 0 keeps every split
    bool secondMoment = true;   ///< a^2 = mean of ratio^2; false: a = mean of ratio
    Float floor = 0.05f;        ///< of the sampler, for judging
};

/// Builds a VisibilityTree. Deterministic for any number of threads.
///
/// Estimate in a cell: a_l^2 = sum w r^2 / sum w over its tries of l, pulled towards the parent's by `shrinkage` pseudo-tries
/// against n = (sum w)^2 / sum w^2 effective ones, from the root down. The root's is pulled towards the mean over all lights.
/// A row that cannot name all lights tells what it misses: the share of those cut off, and for lights that no try met
/// the share of those that only one try met (Good 1953).
/// Size: cells are split while they hold more than 4 `records` records. Then one half of the records makes estimates and the
/// other judges them by the second moment of the estimator, sum_l f_l^2 / p_l, relative to the unoccluded sum squared:
/// children that do not lower it are merged, from the leaves up to the whole box. At last everything is estimated again
/// from all records.
class VisibilityTreeBuilder {
  public:
    VisibilityTreeBuilder(const Bounds3 &bounds, std::span<const VisibilityRecord> records, std::span<const VisibilityTry> tries,
                          const VisibilityBuildSettings &settings);
    VisibilityTree Build();

    size_t LeavesBeforePruning() const { return leavesBefore_; }
    /// After Build, for views: the leaves, and for every node of the frozen cells the records of its leaf.
    const std::vector<LeafSize> &Leaves() const { return leaves_; }
    const std::vector<uint32_t> &RecordsPerNode() const { return recordsPerNode_; }

  private:
    /// Sums over a cell's tries of one light.
    struct Sum {
        uint32_t light = 0;
        double wr = 0, w = 0, w2 = 0;  ///< of w ratio^2 (or ratio), w, w^2
        double mass = 0;               ///< of w ratio: share of the unoccluded light that arrives
    };
    struct Factor {
        uint32_t light = 0;
        float a = 0, mass = 0;
    };
    struct Node {
        uint32_t begin = 0, end = 0;  ///< of order_
        uint32_t firstChild = 0;      ///< 0: none
        uint32_t parent = 0;
        int depth = 0;
        std::vector<Sum> sums;
        std::vector<Factor> factors;  ///< sorted by light
        float unmet = 0;    ///< thereof by lights that no try met, here or above
        float missing = 0;            ///< share of the light found by lights that are not in `factors`
        bool pruned = false;          ///< children are not used
    };
    void Divide();
    void SumUp(int half);
    void Estimate();
    void EstimateNode(Node &node, const Node *above) const;
    double Loss(const VisibilityRecord &record, const std::vector<Factor> &factors) const;
    void Prune();
    VisibilityTree Freeze();
    bool IsLeaf(const Node &n) const { return n.firstChild == 0 || n.pruned; }
    const Factor *Find(const std::vector<Factor> &factors, uint32_t light) const;

    Bounds3 bounds_;
    std::span<const VisibilityRecord> records_;
    std::span<const VisibilityTry> tries_;
    VisibilityBuildSettings settings_;
    bool fullRows_;
    CellOctree cells_;
    std::vector<glm::uvec3> quantized_;
    std::vector<uint32_t> order_;  ///< records, cell by cell
    std::vector<Node> nodes_;      ///< children after their parents; nodes_[0] is the whole box
    Factor prior_;
    size_t leavesBefore_ = 0;
    std::vector<LeafSize> leaves_;
    std::vector<uint32_t> recordsPerNode_;
};

}  // namespace ext
