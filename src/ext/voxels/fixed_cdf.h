#pragma once
#include <cstdint>
#include <span>

#include "pbrt/math/rng.h"

namespace ext {
using namespace pbrt;

// A discrete distribution in 4 bytes an entry: where each entry begins, in units of 2^-32; the first begins at 0 and
// the last ends at 1. Differences are exact, so the probabilities sum to 1 and none is lost beside larger ones, as it
// would be with running sums in float.

/// In proportion to the weights (>= 0, finite; all 0: equal shares). Every entry gets at least 2^-32.
void BuildFixedCdf(std::span<const double> weights, std::span<uint32_t> begins);

inline Float FixedCdfPMF(std::span<const uint32_t> begins, uint32_t index) {
    uint64_t end = index + 1 < begins.size() ? begins[index + 1] : uint64_t(1) << 32;
    return static_cast<Float>(end - begins[index]) * 0x1p-32f;
}

inline Float FixedCdfBegin(std::span<const uint32_t> begins, uint32_t index) {
    return static_cast<Float>(begins[index]) * 0x1p-32f;
}

/// Entry for a uniform number. `p` only extends it: a float near 1 has 24 bits, too few to meet narrow entries with the
/// right frequency, so the bits below its last are a hash of it and the place it is used at.
uint32_t SampleFixedCdf(std::span<const uint32_t> begins, Float u, const Point3 &p);

}  // namespace ext
