#include "ext/visibility/structure_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace ext {

std::string DescribeLeaves(const std::vector<LeafSize> &leaves) {
    struct Level {
        size_t leaves = 0, empty = 0;
        uint64_t records = 0;
    };
    std::map<int, Level> levels;
    std::vector<uint32_t> perLeaf;
    for (const LeafSize &leaf : leaves) {
        Level &level = levels[leaf.depth];
        ++level.leaves;
        level.empty += leaf.records == 0;
        level.records += leaf.records;
        perLeaf.push_back(leaf.records);
    }
    if (perLeaf.empty()) return "";
    std::sort(perLeaf.begin(), perLeaf.end());
    auto quantile = [&](double q) { return perLeaf[size_t(q * double(perLeaf.size() - 1) + 0.5)]; };

    std::string text = "depth     leaves    without records    records    records per leaf\n";
    for (const auto &[depth, level] : levels)
        text += fmt::format("{:5} {:10} {:18} {:10} {:19.1f}\n", depth, level.leaves, level.empty, level.records,
                            double(level.records) / double(level.leaves));
    text += "records per leaf, all leaves: ";
    for (double q : {0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 1.0}) text += fmt::format(" {:g} %: {} ", 100 * q, quantile(q));
    auto firstFilled = std::upper_bound(perLeaf.begin(), perLeaf.end(), 0u);
    if (auto filled = perLeaf.end() - firstFilled; filled > 0)
        text += fmt::format("\nmedian of the {} leaves with records: {}", filled, firstFilled[filled / 2]);
    return text + "\n";
}

}  // namespace ext
