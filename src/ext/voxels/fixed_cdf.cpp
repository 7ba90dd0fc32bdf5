#include "ext/voxels/fixed_cdf.h"

#include <algorithm>

#include "pbrt/core/error.h"

namespace ext {

void BuildFixedCdf(std::span<const double> weights, std::span<uint32_t> begins) {
    const size_t n = weights.size();
    PBRT_CHECK(n == begins.size() && n < (uint64_t(1) << 32));
    double total = 0;
    for (double w : weights) total += w;
    // The remainder after one unit per entry is distributed in proportion.
    const double units = static_cast<double>((uint64_t(1) << 32) - n);
    double running = 0;
    for (size_t i = 0; i < n; ++i) {
        begins[i] = static_cast<uint32_t>(std::min(running, 1.0) * units) + static_cast<uint32_t>(i);
        running += total > 0 ? weights[i] / total : 1 / static_cast<double>(n);
    }
}

uint32_t SampleFixedCdf(std::span<const uint32_t> begins, Float u, const Point3 &p) {
    // Float spacing at u, in units; less than one below 2^-8.
    auto spacing = (std::bit_cast<uint32_t>(u) & 0x7f800000u);
    auto fine = static_cast<double>(std::bit_cast<Float>(spacing) * 0x1p-23f) * 0x1p32;
    auto target = static_cast<double>(u) * 0x1p32 + fine * static_cast<double>(HashFloat(p, u));
    auto unit = static_cast<uint32_t>(std::min(target, 0x1.fffffffep31));
    return static_cast<uint32_t>(std::upper_bound(begins.begin(), begins.end(), unit) - begins.begin()) - 1;
}

}  // namespace ext
