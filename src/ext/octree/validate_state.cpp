// What learned structures must fulfil before they are used, where they come from a file. Loading checks lengths as it
// goes; these functions check what a structure of these lengths says.
#include <algorithm>
#include <cmath>

#include "ext/octree/light_octree.h"
#include "ext/octree/visibility_octree_light_sampler.h"

namespace ext {

namespace {

bool IsFinite(const Vector3 &v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }
bool IsPositive(Float v) { return v >= 0 && std::isfinite(v); }

/// Of a structure that leaves of an octree refer to.
std::optional<std::string> ValidateDepth(const CellOctree &cells, size_t rows, size_t leaves, int depth) {
    if (std::optional<std::string> fault = cells.Validate(rows)) return fault;
    std::vector<bool> used(rows, false);
    size_t count = 0;
    int deepest = 0;
    cells.ForEachLeaf([&](uint32_t, uint32_t row, int at) {
        ++count;
        used[row] = true;
        deepest = std::max(deepest, at);
    });
    if (std::find(used.begin(), used.end(), false) != used.end()) return "a row belongs to no leaf";
    // Leaves above the top grid are spread over its cells.
    if (leaves < rows || leaves > count || (deepest > 2 ? depth != deepest : depth < 0 || depth > 2))
        return "the numbers of leaves and levels do not fit the octree";
    return {};
}

}  // namespace

std::optional<std::string> CellOctree::Validate(size_t rows) const {
    if (!IsFinite(low_) || !IsPositive(scale_.x) || !IsPositive(scale_.y) || !IsPositive(scale_.z))
        return "the box of an octree is not finite";
    if (nodes_.size() < TopCount || (nodes_.size() - TopCount) % 8 != 0) return "an octree lacks nodes";
    // Depth of every block of eight children; 0: not reached. Children come after their parents.
    std::vector<uint8_t> depth((nodes_.size() - TopCount) / 8, 0);
    for (size_t i = 0; i < nodes_.size(); ++i) {
        const uint32_t node = nodes_[i];
        const int here = i < TopCount ? 2 : depth[(i - TopCount) / 8];
        if (here == 0) return "a node of an octree is not reached";
        if (node & LeafBit) {
            if ((node & ~LeafBit) >= rows) return "a leaf of an octree has no row";
            continue;
        }
        const size_t block = (size_t(node) - TopCount) / 8;
        if (node <= i || node < TopCount || (node - TopCount) % 8 != 0 || block >= depth.size() || depth[block] != 0)
            return "a node of an octree has no children of its own";
        if (here == MaxDepth) return "an octree is too deep";
        depth[block] = static_cast<uint8_t>(here + 1);
    }
    return {};
}

std::optional<std::string> VisibilityTree::Validate() const {
    if (RowCount() == 0) {
        const bool isEmpty = offset_.empty() && nodes_.empty() && codes_.empty() && leaves_ == 0 && depth_ == 0;
        return isEmpty ? std::nullopt : std::optional("an octree has leaves and no rows");
    }
    if (offset_[0] != 0 || offset_.back() != codes_.size() || (!nodes_.empty() && nodes_.size() != codes_.size()) ||
        std::adjacent_find(offset_.begin(), offset_.end(), std::greater_equal<>()) != offset_.end())
        return "the rows of an octree do not follow each other";
    return ValidateDepth(cells_, RowCount(), leaves_, depth_);
}

std::optional<std::string> LightOctree::Validate() const {
    if (groups_ == 0 || cdf_.empty()) {
        const bool isEmpty = groups_ == 0 && cdf_.empty() && leaves_ == 0 && depth_ == 0;
        return isEmpty ? std::nullopt : std::optional("an octree has lights and no rows");
    }
    if (cdf_.size() % groups_ != 0) return "a row of an octree lacks lights";
    for (uint32_t row = 0; row < RowCount(); ++row) {
        const std::span<const Float> cdf = Cdf(row);
        if (!(cdf[0] >= 0) || cdf.back() != 1 || !std::is_sorted(cdf.begin(), cdf.end()))
            return "the probabilities of a row do not add up to 1";
    }
    return ValidateDepth(cells_, RowCount(), leaves_, depth_);
}

std::optional<std::string> VisibilityRecords::Validate(size_t groups, const LightTree *lights) const {
    size_t next = 0;
    for (const VisibilityRecord &r : records) {
        if (r.firstTry != next || r.tryCount == 0 || r.tryCount > tries.size() - next)
            return "the shadow rays of records do not follow each other";
        if (!IsFinite(r.p)) return "a record lies at no finite place";
        next += r.tryCount;
    }
    if (next != tries.size()) return "shadow rays belong to no record";
    for (const VisibilityTry &t : tries) {
        if (t.light >= groups || (lights && lights->PositionOf(t.light) == LightTree::kNowhere))
            return "a shadow ray goes to a light that does not exist";
        if (!IsPositive(t.share) || !IsPositive(t.weight) || !IsPositive(t.ratio))
            return "a shadow ray found what is not a finite number";
    }
    return {};
}

std::optional<std::string> VisibilityOctreeLightSampler::Knowledge::Validate(size_t groups,
                                                                             const LightTree *lights) const {
    if (std::optional<std::string> fault = known.Validate(groups, lights)) return fault;
    if (learned != (tree.RowCount() > 0)) return "there are no rows to choose lights by";
    if (!learned) return {};
    if (recordsPerNode.size() != tree.Cells().NodeCount() || leaves.size() != tree.LeafCount())
        return "counts of records do not fit the octree";
    for (const LeafSize &leaf : leaves)
        if (leaf.depth < 0 || leaf.depth > tree.Depth()) return "a leaf is deeper than its octree";
    for (uint32_t r = 0; r < tree.RowCount(); ++r) {
        const VisibilityTree::Row row = tree.GetRow(r);
        if (lights ? row.nodes.size() > kMax || !lights->IsCut(row.nodes)
                   : !row.nodes.empty() || row.codes.size() != groups)
            return "a row of an octree is not of all lights";
    }
    return {};
}

}  // namespace ext
