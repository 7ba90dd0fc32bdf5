// Inspect and DescribeStructure: what the octree has learned, as text and numbers for people.
#include <algorithm>

#include "ext/octree/paper_octree_light_sampler.h"
#include "ext/octree/structure_text.h"
#include "ext/octree/visibility_octree_light_sampler.h"

namespace ext {

void PaperOctreeLightSampler::Inspect(const LightQuery &query, std::vector<InspectedValue> &values) const {
    CellOctree::Cell cell;
    double records = 0;
    if (learned_) {
        cell = tree_.Cells().CellAt(query.p);
        records = recordsPerNode_[cell.node];
    }
    values.push_back({"leaf", static_cast<double>(cell.node), true});
    values.push_back({"leaf records", records, false});
    values.push_back({"leaf depth", static_cast<double>(cell.depth), false});
}

std::string PaperOctreeLightSampler::DescribeStructure() const {
    if (!learned_) return fmt::format("octree: none, there is nothing to choose ({} lights)\n", groups_.Size());

    std::vector<LeafSize> leaves;
    tree_.Cells().ForEachLeaf([&](uint32_t node, uint32_t, int depth) {
        leaves.push_back({depth, recordsPerNode_[node]});
    });
    return fmt::format(
               "octree: {} leaves, {} distributions over {} lights, {} records\nbytes: {} (and {} for this view)\n",
               leaves.size(), tree_.RowCount(), groups_.Size(), vertices_, tree_.Bytes(),
               recordsPerNode_.capacity() * sizeof(uint32_t)) +
           DescribeLeaves(leaves);
}

void VisibilityOctreeLightSampler::Inspect(const LightQuery &query, std::vector<InspectedValue> &values) const {
    const auto &[known, tree, learned, leaves, recordsPerNode, leavesBefore] = KnowledgeAt(query);
    CellOctree::Cell cell;
    double records = 0;
    if (learned) {
        cell = tree.Cells().CellAt(query.p);
        records = recordsPerNode[cell.node];
    }
    values.push_back({"leaf", static_cast<double>(cell.row), true});
    values.push_back({"leaf records", records, false});
    values.push_back({"leaf depth", static_cast<double>(cell.depth), false});
    if (windows_) windows_->Inspect(query.p, values);
    if (lightTree_) return;
    // The factor a(leaf, l) of each light, relative to the largest in the leaf.
    for (size_t i = 0; i < std::min<size_t>(groups_.Size(), 16); ++i)
        values.push_back({fmt::format("found {}", i),
                          learned ? static_cast<double>(VisibilityTree::Decode(tree.GetRow(cell.row).codes[i])) : 1.0,
                          false});
}

std::string VisibilityOctreeLightSampler::DescribeStructure() const {
    auto describe = [&](const char *what, const Knowledge &k) {
        if (!k.learned) return std::string();
        return fmt::format("octree{}: {} leaves ({} before pruning), {} different rows over {} lights, bytes: {}\n",
                           what, k.tree.LeafCount(), k.leavesBefore, k.tree.RowCount(), groups_.Size(),
                           k.tree.Bytes()) +
               DescribeLeaves(k.leaves);
    };
    const std::string text = describe("", onSurfaces_) + describe(" inside media", inMedia_);
    const std::string windows = windows_ ? windows_->Describe() : "";
    if (text.empty() && !windows_)
        return fmt::format("octree: none, there is nothing to choose ({} lights)\n", groups_.Size());
    if (text.empty()) return windows;
    return text + fmt::format("prepass: {} records, {} shadow rays\n", prepassRecords_, prepassTries_) + windows;
}

}  // namespace ext
