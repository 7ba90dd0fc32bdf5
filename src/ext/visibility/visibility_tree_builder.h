#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ext/visibility/cell_cut.h"
#include "ext/visibility/visibility_tree.h"

namespace ext {

/// Shadow ray from record x to light (group) l, of the prepass or the render.
struct ShadowRay {
    uint32_t light = 0;
    Float share = 0;   ///< G_l(x) / sum of G over all lights; if lights are drawn, the sum is estimated from the
                       ///< record's shadow rays
    Float weight = 0;  ///< share over the expected number of draws of the light; a record's weights sum to 1
    Float ratio = 0;   ///< measured contribution / G_l(x)
};

/// A point with consecutive shadow rays.
struct VisibilityRecord {
    Point3 p{};
    uint32_t firstRay = 0, rayCount = 0;
};

struct VisibilityBuildSettings {
    int lightCount = 0;
    const LightTree *lights = nullptr;  ///< light tree whose cuts the rows are; null: rows cover all lights
    int cut = 48;                       ///< nodes per row, excluding far lights
    int records = 50;                   ///< target per leaf
    int raysPerRecord = 1;              ///< shadow rays that count as one record; only with a light tree
    Float shrinkage = 4;                ///< pseudo-rays of the parent's estimate
    Float pruneGain =
        0.01f;  ///< minimum relative reduction of the held-out second moment by a split; 0 keeps every split
    bool secondMoment = true;  ///< a^2 = mean of ratio^2; false: a = mean of ratio
    Float floor = 0.05f;       ///< the sampler's floor, used to evaluate splits
};

/// Builds a VisibilityTree. Deterministic for any number of threads.
///
/// Estimate in a cell: a_l^2 = sum w r^2 / sum w over its shadow rays to l. `shrinkage` pseudo-rays, against n = (sum
/// w)^2 / sum w^2 effective rays, shrink it towards the parent's estimate, from the root down. The root's estimate
/// shrinks towards the mean over all lights. With a light tree, CellCut provides the estimates.
///
/// Size: cells are split while they hold more than 4 `records` records. One half of the records then provides
/// estimates, the held-out half the second moment, sum_l f_l^2 / p_l, relative to the squared unoccluded sum. Children
/// that do not reduce it are merged, bottom-up. Finally all estimates are recomputed from all records.
///
/// With a light tree, cells are split while they hold more than `records`, without merging. A few shadow rays per
/// record cannot evaluate splits, and small cells are harmless, as they only adjust their parent's estimate.
class VisibilityTreeBuilder {
  public:
    VisibilityTreeBuilder(const Bounds3 &bounds, std::span<const VisibilityRecord> records,
                          std::span<const ShadowRay> rays, const VisibilityBuildSettings &settings);
    /// Returns the tree; empty if `stop` returned true. Threads call `stop` concurrently and often. Call Build once.
    std::optional<VisibilityTree> Build(const std::function<bool()> &stop = {});

    /// Valid after Build.
    size_t LeavesBeforePruning() const { return leavesBefore_; }
    /// Valid after Build, for inspection: leaves, and records per leaf, indexed by CellOctree::Cell::node.
    const std::vector<LeafSize> &Leaves() const { return leaves_; }
    const std::vector<uint32_t> &RecordsPerNode() const { return recordsPerNode_; }

  private:
    struct Node {
        uint32_t begin = 0, end = 0;  ///< range in order_
        uint32_t firstChild = 0;      ///< 0: none
        uint32_t parent = 0;
        int depth = 0;
        std::vector<ShadowRaySums> sums;
        std::vector<float> factors;  ///< per light
        CellCut cut;                 ///< with a light tree, instead of factors
        bool pruned = false;         ///< children are unused
    };
    bool Stopped() const;
    void Divide();
    void SumUp(int half);
    void Estimate();
    void EstimateNode(Node &node, const Node *above) const;
    uint32_t NameOf(uint32_t light) const { return settings_.lights ? settings_.lights->PositionOf(light) : light; }
    double Loss(const VisibilityRecord &record, const std::vector<float> &factors) const;
    void Prune();
    VisibilityTree Freeze();
    bool IsLeaf(const Node &n) const { return n.firstChild == 0 || n.pruned; }

    Bounds3 bounds_;
    std::span<const VisibilityRecord> records_;
    std::span<const ShadowRay> rays_;
    VisibilityBuildSettings settings_;
    const std::function<bool()> *stop_ = nullptr;
    mutable std::atomic<bool> stopped_ = false;
    CellOctree cells_;
    std::vector<glm::uvec3> quantized_;
    std::vector<uint32_t> order_;  ///< records, grouped by cell
    std::vector<Node> nodes_;      ///< children follow their parents; nodes_[0] is the root
    double prior_ = 1;
    size_t leavesBefore_ = 0;
    std::vector<LeafSize> leaves_;
    std::vector<uint32_t> recordsPerNode_;
};

struct LeafSize {
    int depth = 0;
    uint32_t records = 0;
};

/// Leaves and records by depth, and quantiles of records per leaf, as text.
std::string DescribeLeaves(const std::vector<LeafSize> &leaves);

}  // namespace ext
