#pragma once
#include <cstdint>
#include <span>

#include "pbrt/math/rng.h"

namespace ext {
using namespace pbrt;

// Discrete distribution with 4 bytes per entry: its start in the CDF, in units of 2^-32, from 0; the last entry ends at
// 1. Differences are exact: probabilities sum to 1, and small ones survive beside large ones, unlike with float running
// sums.

/// Builds a distribution proportional to the weights (>= 0, finite; uniform if all are 0). Every entry gets at least
/// 2^-32.
void BuildFixedCdf(std::span<const double> weights, std::span<uint32_t> begins);

inline Float FixedCdfPMF(std::span<const uint32_t> begins, uint32_t index) {
    uint64_t end = index + 1 < begins.size() ? begins[index + 1] : uint64_t(1) << 32;
    return Float(end - begins[index]) * 0x1p-32f;
}

inline Float FixedCdfBegin(std::span<const uint32_t> begins, uint32_t index) { return Float(begins[index]) * 0x1p-32f; }

/// Entry for a uniform number u. A float near 1 has 24 bits, too few for narrow entries, so lower bits come from a hash
/// of u and the query point `p`.
uint32_t SampleFixedCdf(std::span<const uint32_t> begins, Float u, const Point3 &p);

}  // namespace ext
