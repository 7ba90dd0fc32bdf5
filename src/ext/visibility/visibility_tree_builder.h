#pragma once
#include <atomic>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "ext/visibility/cell_cut.h"
#include "ext/visibility/structure_text.h"
#include "ext/visibility/visibility_tree.h"

namespace ext {

/// One shadow ray from record x to light (group) l, of the prepass or of the render.
struct ShadowRay {
    uint32_t light = 0;
    Float share =
        0;  ///< G_l(x) / sum of G over all lights, that sum estimated from the record's shadow rays if they are drawn
    Float weight =
        0;  ///< share, divided by the number of times the light was to be drawn; a record's weights add up to 1
    Float ratio = 0;  ///< contribution found / G_l(x)
};

/// A point from which shadow rays were traced; its shadow rays are consecutive.
struct VisibilityRecord {
    Point3 p{};
    uint32_t firstRay = 0, rayCount = 0;
};

struct VisibilityBuildSettings {
    int lightCount = 0;
    const LightTree *lights = nullptr;  ///< rows are cuts through it; null: rows name all lights
    int cut = 48;                       ///< nodes of such a row, far lights not counted
    int records = 50;                   ///< a leaf wants about this many
    int raysPerRecord = 1;              ///< shadow rays that count as one record; used with a light tree only
    Float shrinkage = 4;                ///< pseudo-rays of the parent's estimate
    Float pruneGain = 0.01f;   ///< a split must lower the held-out second moment by this share; 0 keeps every split
    bool secondMoment = true;  ///< a^2 = mean of ratio^2; false: a = mean of ratio
    Float floor = 0.05f;       ///< the sampler's floor, used when splits are judged
};

/// Builds a VisibilityTree. Deterministic for any number of threads.
///
/// Estimate in a cell: a_l^2 = sum w r^2 / sum w over its shadow rays of l, pulled towards the parent's by `shrinkage`
/// pseudo-rays against n = (sum w)^2 / sum w^2 effective ones, from the root down. The root's estimate is pulled
/// towards the mean over all lights. Where there is a light tree, CellCut makes the estimates. Size: cells are split
/// while they hold more than 4 `records` records. Then one half of the records makes estimates and the other judges
/// them by the second moment of the estimator, sum_l f_l^2 / p_l, relative to the unoccluded sum squared: children that
/// do not lower it are merged, from the leaves up to the whole box. At last everything is estimated again from all
/// records. Where there is a light tree cells are split while they hold more than `records`, and nothing is merged: a
/// few shadow rays a record judge too badly, and small cells are harmless, as they only adjust what the cell above
/// says.
class VisibilityTreeBuilder {
  public:
    VisibilityTreeBuilder(const Bounds3 &bounds, std::span<const VisibilityRecord> records,
                          std::span<const ShadowRay> rays, const VisibilityBuildSettings &settings);
    /// The tree; empty if `stop` returned true meanwhile. Several threads call `stop`, often. Call Build once per
    /// builder.
    std::optional<VisibilityTree> Build(const std::function<bool()> &stop = {});

    /// After Build.
    size_t LeavesBeforePruning() const { return leavesBefore_; }
    /// After Build, for views: the leaves, and the number of records of each leaf, indexed by CellOctree::Cell::node.
    const std::vector<LeafSize> &Leaves() const { return leaves_; }
    const std::vector<uint32_t> &RecordsPerNode() const { return recordsPerNode_; }

  private:
    struct Node {
        uint32_t begin = 0, end = 0;  ///< of order_
        uint32_t firstChild = 0;      ///< 0: none
        uint32_t parent = 0;
        int depth = 0;
        std::vector<ShadowRaySums> sums;
        std::vector<float> factors;  ///< per light
        CellCut cut;                 ///< instead, where there is a light tree
        bool pruned = false;         ///< children are not used
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
    std::vector<uint32_t> order_;  ///< records, cell by cell
    std::vector<Node> nodes_;      ///< children after their parents; nodes_[0] is the whole box
    double prior_ = 1;
    size_t leavesBefore_ = 0;
    std::vector<LeafSize> leaves_;
    std::vector<uint32_t> recordsPerNode_;
};

}  // namespace ext
