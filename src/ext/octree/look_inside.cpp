// Inspect and DescribeStructure: what the octree has learned, for people.
#include <algorithm>
#include <map>
#include <numeric>

#include "ext/octree/visibility_octree_light_sampler.h"

namespace ext {

void VisibilityOctreeLightSampler::Inspect(const LightQuery &query, std::vector<InspectedValue> &values) const {
    LightOctree::Cell cell;
    double records = 0;
    if (learned_) {
        cell = tree_.CellAt(query.p);
        records = recordsPerNode_[cell.node];
    }
    values.push_back({"leaf", static_cast<double>(cell.node), true});
    values.push_back({"leaf records", records, false});
    values.push_back({"leaf depth", static_cast<double>(cell.depth), false});
}

std::string VisibilityOctreeLightSampler::DescribeStructure() const {
    if (!learned_) return fmt::format("octree: none, there is nothing to choose ({} lights)\n", groups_.Size());

    struct Level {
        size_t leaves = 0, empty = 0;
        uint64_t records = 0;
    };
    std::map<int, Level> levels;
    std::vector<uint32_t> perLeaf;
    tree_.ForEachLeaf([&](uint32_t node, uint32_t, int depth) {
        Level &level = levels[depth];
        ++level.leaves;
        level.empty += recordsPerNode_[node] == 0;
        level.records += recordsPerNode_[node];
        perLeaf.push_back(recordsPerNode_[node]);
    });
    std::sort(perLeaf.begin(), perLeaf.end());
    auto quantile = [&](double q) { return perLeaf[static_cast<size_t>(q * static_cast<double>(perLeaf.size() - 1) + 0.5)]; };

    std::string text = fmt::format("octree: {} leaves, {} distributions over {} lights, {} records\n", perLeaf.size(),
                                   tree_.RowCount(), groups_.Size(), vertices_);
    text += fmt::format("bytes: {} (and {} for this view)\n", tree_.Bytes(), recordsPerNode_.capacity() * sizeof(uint32_t));
    text += "depth     leaves    without records    records    records per leaf\n";
    for (const auto &[depth, level] : levels)
        text += fmt::format("{:5} {:10} {:18} {:10} {:19.1f}\n", depth, level.leaves, level.empty, level.records,
                            static_cast<double>(level.records) / static_cast<double>(level.leaves));
    text += "records per leaf, all leaves: ";
    for (double q : {0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 1.0}) text += fmt::format(" {:g} %: {} ", 100 * q, quantile(q));
    auto firstFilled = std::upper_bound(perLeaf.begin(), perLeaf.end(), 0u);
    if (auto filled = perLeaf.end() - firstFilled; filled > 0)
        text += fmt::format("\nmedian of the {} leaves with records: {}", filled, firstFilled[filled / 2]);
    return text + "\n";
}

}  // namespace ext
