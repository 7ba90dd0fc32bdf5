#pragma once
#include <algorithm>
#include <atomic>
#include <functional>
#include <map>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

#include "ext/visibility/cell_cut.h"
#include "ext/visibility/visibility_tree.h"
#include "pbrt/core/parallel.h"
#include "pbrt/math/rng.h"

namespace ext {

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
/// shrinks towards the mean over all lights. Lights that no shadow ray of the cell reached get at most about as much
/// weight as the others (see CellCut, which provides the estimates with a light tree).
///
/// Size: cells are split while they hold more than 4 `records` records. One half of the records then provides
/// estimates, the held-out half the second moment, sum_l f_l^2 / p_l, relative to the record's squared light. Children
/// that do not reduce it are merged, bottom-up. Finally all estimates are recomputed from all records.
///
/// With a light tree, cells are split while they hold more than `records`, without merging. A few shadow rays per
/// record cannot evaluate splits, and small cells are harmless, as they only adjust their parent's estimate.
class VisibilityTreeBuilder {
  public:
    VisibilityTreeBuilder(const Bounds3 &bounds, std::span<const VisibilityRecord> records,
                          std::span<const ShadowRay> rays, const VisibilityBuildSettings &settings)
        : bounds_(bounds), records_(records), rays_(rays), settings_(settings), cells_(bounds) {}
    /// Returns the tree; empty if `stop` returned true. Threads call `stop` concurrently and often. Call Build once.
    std::optional<VisibilityTree> Build(const std::function<bool()> &stop = {}) {
        stop_ = &stop;
        Divide();
        if (settings_.pruneGain > 0 && !settings_.lights) {
            SumUp(0);
            Estimate();
            Prune();
        }
        SumUp(kAllRecords);
        Estimate();
        if (Stopped()) return {};
        VisibilityTree tree = Freeze();
        if (Stopped()) return {};
        return tree;
    }

    size_t LeavesBeforePruning() const { return leavesBefore_; }  ///< valid after Build
    /// Valid after Build, for inspection: leaves, and records per leaf, indexed by CellOctree::Cell::node.
    const std::vector<LeafSize> &Leaves() const { return leaves_; }
    const std::vector<uint32_t> &RecordsPerNode() const { return recordsPerNode_; }

  private:
    static constexpr int kAllRecords = -1;
    /// Cross-validation half of a record: 0 provides estimates, 1 evaluates them (Prune).
    static int HalfOf(uint32_t record) { return int(MixBits(record) & 1); }

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
    /// Latches the first true result of `stop`, so that no step reads unfinished results of another.
    bool Stopped() const {
        if (stopped_.load(std::memory_order_relaxed)) return true;
        if (!*stop_ || !(*stop_)()) return false;
        stopped_.store(true, std::memory_order_relaxed);
        return true;
    }
    void Divide() {
        quantized_.resize(records_.size());
        for (size_t i = 0; i < records_.size(); ++i) quantized_[i] = cells_.Quantize(records_[i].p);
        order_.resize(records_.size());
        std::iota(order_.begin(), order_.end(), 0u);
        nodes_.resize(1);
        nodes_[0].end = uint32_t(order_.size());
        const auto splitAbove = size_t(settings_.records) * (settings_.lights ? settings_.raysPerRecord : 4);
        auto sizeOf = [&](uint32_t begin, uint32_t end) {
            if (!settings_.lights) return size_t(end - begin);
            size_t rays = 0;
            for (uint32_t i = begin; i < end; ++i) rays += records_[order_[i]].rayCount;
            return rays;
        };
        for (uint32_t n = 0; n < nodes_.size() && !Stopped(); ++n) {
            const uint32_t begin = nodes_[n].begin, end = nodes_[n].end;
            const int depth = nodes_[n].depth, bit = CellOctree::MaxDepth - 1 - depth;
            if (sizeOf(begin, end) <= splitAbove || bit < 0) {
                ++leavesBefore_;
                continue;
            }
            uint32_t start[9];
            SortIntoChildren(quantized_, order_, begin, end, bit, start);
            const auto first = uint32_t(nodes_.size());
            nodes_[n].firstChild = first;
            nodes_.resize(first + 8);
            for (uint32_t c = 0; c < 8; ++c) {
                nodes_[first + c].begin = start[c];
                nodes_[first + c].end = start[c + 1];
                nodes_[first + c].parent = n;
                nodes_[first + c].depth = depth + 1;
            }
        }
    }
    void SumUp(int half) {
        // Sorts by light and sums the entries of each light in their original order.
        auto compress = [](std::vector<ShadowRaySums> &sums) {
            std::vector<uint64_t> order(sums.size());
            for (size_t i = 0; i < sums.size(); ++i) order[i] = uint64_t(sums[i].light) << 32 | i;
            std::sort(order.begin(), order.end());
            std::vector<ShadowRaySums> sorted;
            sorted.reserve(sums.size());
            for (uint64_t o : order) {
                const ShadowRaySums &s = sums[o & 0xffffffffu];
                if (!sorted.empty() && sorted.back().light == s.light) sorted.back() += s;
                else sorted.push_back(s);
            }
            sums.assign(sorted.begin(), sorted.end());
            sums.shrink_to_fit();
        };
        const bool all = settings_.lights == nullptr;
        ParallelForEach(nodes_.size(), 16, [&](int64_t n) {
            if (Stopped()) return;
            Node &node = nodes_[n];
            node.sums.clear();
            if (node.firstChild != 0) return;
            if (all) node.sums.resize(settings_.lightCount);
            for (uint32_t i = node.begin; i < node.end; ++i) {
                if (half != kAllRecords && HalfOf(order_[i]) != half) continue;
                const VisibilityRecord &record = records_[order_[i]];
                for (uint32_t t = record.firstRay; t < record.firstRay + record.rayCount; ++t) {
                    const ShadowRay &v = rays_[t];
                    const auto w = double(v.weight), r = double(v.ratio);
                    const ShadowRaySums s{NameOf(v.light), w * (settings_.secondMoment ? r * r : r), w, w * w};
                    if (all) {
                        node.sums[v.light].light = v.light;
                        node.sums[v.light] += s;
                    } else {
                        node.sums.push_back(s);
                    }
                }
            }
            if (all) std::erase_if(node.sums, [](const ShadowRaySums &s) { return !(s.w > 0); });
            else compress(node.sums);
        });
        for (size_t n = nodes_.size(); n-- > 0 && !Stopped();) {
            Node &node = nodes_[n];
            if (node.firstChild == 0) continue;
            for (uint32_t c = 0; c < 8; ++c) {
                const std::vector<ShadowRaySums> &child = nodes_[node.firstChild + c].sums;
                node.sums.insert(node.sums.end(), child.begin(), child.end());
            }
            compress(node.sums);
        }
    }
    void Estimate() {
        ShadowRaySums all;
        for (const ShadowRaySums &s : nodes_[0].sums) all += s;
        const double mean = all.w > 0 && all.wm > 0 ? all.wm / all.w : 1;
        prior_ = settings_.secondMoment ? std::sqrt(mean) : mean;
        // Parents precede children, and nodes of equal depth are consecutive (breadth-first).
        for (size_t begin = 0, end = 0; begin < nodes_.size(); begin = end) {
            while (end < nodes_.size() && nodes_[end].depth == nodes_[begin].depth) ++end;
            ParallelForEach(end - begin, 8, [&](int64_t index) {
                Node &node = nodes_[begin + index];
                if (!Stopped()) EstimateNode(node, begin == 0 ? nullptr : &nodes_[node.parent]);
            });
        }
    }
    void EstimateNode(Node &node, const Node *above) const {
        node.factors.clear();
        const auto k = double(settings_.shrinkage);
        if (settings_.lights) {
            double weight = 0;
            for (const ShadowRaySums &s : node.sums) weight += s.w;
            // Four times the pseudo-rays, as the shrinkage targets (parent cell, neighbouring lights) are better
            // estimates.
            node.cut = CellCut(*settings_.lights, node.sums, weight, above ? &above->cut : nullptr,
                               {4 * k, settings_.secondMoment, size_t(settings_.cut)},
                               [&](auto &&visit) { ForEachRecord(node, visit); });
            return;
        }
        std::vector<const ShadowRaySums *> of(settings_.lightCount, nullptr);
        for (const ShadowRaySums &s : node.sums) of[s.light] = &s;
        for (uint32_t l = 0; l < of.size(); ++l) {
            const ShadowRaySums *s = of[l];
            const double before = above ? double(above->factors[l]) : prior_;
            const double target = settings_.secondMoment ? before * before : before;
            const double n = s ? s->w * s->w / s->w2 : 0, mean = s ? s->wm / s->w : 0;
            const double value = n + k > 0 ? (n * mean + k * target) / (n + k) : target;
            node.factors.push_back(float(settings_.secondMoment ? std::sqrt(value) : value));
        }
        const auto isUnreached = [&](uint32_t l) { return of[l] && !(of[l]->wm > 0); };
        const auto lightOf = [&](const ShadowRay &ray) {
            return std::pair(double(node.factors[ray.light]), isUnreached(ray.light));
        };
        UnreachedLimit limit;
        ForEachRecord(node, [&](std::span<const ShadowRay> record) { limit.Add(record, lightOf); });
        const auto scale = float(limit.Scale());
        for (uint32_t l = 0; l < of.size(); ++l)
            if (isUnreached(l)) node.factors[l] *= scale;
    }
    /// Calls visit with the shadow rays of every record of a node.
    void ForEachRecord(const Node &node, auto &&visit) const {
        for (uint32_t i = node.begin; i < node.end; ++i) {
            const VisibilityRecord &record = records_[order_[i]];
            visit(rays_.subspan(record.firstRay, record.rayCount));
        }
    }
    uint32_t NameOf(uint32_t light) const { return settings_.lights ? settings_.lights->PositionOf(light) : light; }
    double Loss(const VisibilityRecord &record, const std::vector<float> &factors) const {
        double sum = 0, light = 0;
        for (uint32_t t = record.firstRay; t < record.firstRay + record.rayCount; ++t) {
            sum += double(rays_[t].weight) * double(factors[rays_[t].light]);
            light += double(rays_[t].weight) * double(rays_[t].ratio);
        }
        double loss = 0;
        const auto e = double(settings_.floor);
        for (uint32_t t = record.firstRay; t < record.firstRay + record.rayCount; ++t) {
            const ShadowRay &v = rays_[t];
            if (!(v.ratio > 0)) continue;
            const double share = double(v.share);
            double p = e * share;
            if (sum > 0) p += (1 - e) * double(factors[v.light]) * share / sum;
            if (p > 0) loss += double(v.weight) * share * double(v.ratio) * double(v.ratio) / p;
        }
        return light > 0 ? loss / (light * light) : 0;
    }
    void Prune() {
        std::vector<double> best(order_.size(), 0);
        // By levels, as in Estimate, the deepest first.
        for (size_t begin = nodes_.size(), end = begin; end > 0; end = begin) {
            while (begin > 0 && nodes_[begin - 1].depth == nodes_[end - 1].depth) --begin;
            ParallelForEach(end - begin, [&](int64_t index) {
                if (Stopped()) return;
                Node &node = nodes_[begin + index];
                double here = 0, below = 0, squares = 0;
                std::vector<double> loss(node.end - node.begin, 0);
                for (uint32_t i = node.begin; i < node.end; ++i) {
                    if (HalfOf(order_[i]) == 0) continue;
                    double l = loss[i - node.begin] = Loss(records_[order_[i]], node.factors);
                    here += l;
                    below += best[i];
                    squares += (l - best[i]) * (l - best[i]);
                }
                // A split is kept if its gain exceeds both pruneGain of the loss and the noise.
                const double gain = here - below;
                if (node.firstChild != 0 && gain > double(settings_.pruneGain) * here && gain > std::sqrt(squares))
                    return;
                node.pruned = true;
                std::copy(loss.begin(), loss.end(), best.begin() + node.begin);
            });
        }
    }
    VisibilityTree Freeze() {
        VisibilityTree tree;
        tree.cells_ = CellOctree(bounds_);
        tree.offset_.push_back(0);
        using Row = std::pair<std::vector<uint32_t>, std::vector<uint8_t>>;  // nodes, codes
        std::map<Row, uint32_t> known;
        auto rowOf = [&](const Node &node) {
            // Only ratios within a row matter.
            const std::span<const float> factors = settings_.lights ? node.cut.Factors() : node.factors;
            const float most = factors.empty() ? 0 : *std::max_element(factors.begin(), factors.end());
            Row row;
            auto &[names, codes] = row;
            if (settings_.lights) names.assign(node.cut.Nodes().begin(), node.cut.Nodes().end());
            for (float f : factors) codes.push_back(VisibilityTree::Encode(most > 0 ? double(f) / double(most) : 1.0));
            auto [it, isNew] = known.emplace(row, uint32_t(tree.RowCount()));
            if (isNew) {
                tree.nodes_.insert(tree.nodes_.end(), names.begin(), names.end());
                tree.codes_.insert(tree.codes_.end(), codes.begin(), codes.end());
                tree.offset_.push_back(uint32_t(tree.codes_.size()));
            }
            return it->second;
        };
        std::vector<uint32_t> rows(nodes_.size(), 0);
        for (size_t n = 0; n < nodes_.size() && !Stopped(); ++n) {
            const Node &node = nodes_[n];
            bool used = IsLeaf(node);
            for (const Node *up = &node; used && up != &nodes_[0];) {
                up = &nodes_[up->parent];
                used = !up->pruned;
            }
            if (!used) continue;
            rows[n] = rowOf(node);
            ++tree.leaves_;
            leaves_.push_back({node.depth, node.end - node.begin});
            tree.depth_ = std::max(tree.depth_, node.depth);
        }
        for (uint32_t top = 0; top < CellOctree::TopCount; ++top) {
            const glm::uvec3 at(top & 3, (top >> 2) & 3, top >> 4);
            uint32_t n = 0;
            for (int bit = 1; bit >= 0 && !IsLeaf(nodes_[n]); --bit)
                n = nodes_[n].firstChild + CellOctree::Child(at, bit);
            PlaceLeaves(tree.cells_, rows, top, n);
        }
        tree.cells_.ShrinkToFit();
        tree.offset_.shrink_to_fit();
        tree.nodes_.shrink_to_fit();
        tree.codes_.shrink_to_fit();
        return tree;
    }
    /// Sets the leaves of `cell`, which is node n; `rows`: of the leaves.
    void PlaceLeaves(CellOctree &cells, const std::vector<uint32_t> &rows, uint32_t cell, uint32_t n) {
        const Node &node = nodes_[n];
        if (IsLeaf(node)) {
            cells.SetLeaf(cell, rows[n]);
            recordsPerNode_.resize(cells.NodeCount());
            recordsPerNode_[cell] = node.end - node.begin;
            return;
        }
        const uint32_t first = cells.Split(cell);
        for (uint32_t c = 0; c < 8; ++c) PlaceLeaves(cells, rows, first + c, node.firstChild + c);
    }
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

}  // namespace ext
