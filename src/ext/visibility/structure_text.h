#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace ext {

struct LeafSize {
    int depth = 0;
    uint32_t records = 0;
};

/// Leaves and records by depth, and quantiles of records per leaf, as text.
std::string DescribeLeaves(const std::vector<LeafSize> &leaves);

}  // namespace ext
