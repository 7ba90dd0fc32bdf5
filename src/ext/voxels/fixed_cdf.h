#pragma once
#include <cstdint>
#include <span>

#include "pbrt/math/rng.h"

namespace ext {
using namespace pbrt;

// A discrete distribution in 4 bytes an entry: the number at which the entry begins, in units of 2^-32; the first entry
// begins at 0 and the last ends at 1. Differences are exact, so the probabilities sum to 1 and no small one is lost
// beside larger ones, as it would be with running sums in float.

/// Writes a distribution in proportion to the weights (>= 0, finite; if all are 0, equal shares). Every entry gets at
/// least 2^-32.
void BuildFixedCdf(std::span<const double> weights, std::span<uint32_t> begins);

inline Float FixedCdfPMF(std::span<const uint32_t> begins, uint32_t index) {
    uint64_t end = index + 1 < begins.size() ? begins[index + 1] : uint64_t(1) << 32;
    return static_cast<Float>(end - begins[index]) * 0x1p-32f;
}

inline Float FixedCdfBegin(std::span<const uint32_t> begins, uint32_t index) {
    return static_cast<Float>(begins[index]) * 0x1p-32f;
}

/// The entry for a uniform number u. A float near 1 has 24 bits, too few to hit narrow entries with the right
/// frequency, so the bits below its last come from a hash of u and the point `p` of the query.
uint32_t SampleFixedCdf(std::span<const uint32_t> begins, Float u, const Point3 &p);

}  // namespace ext
