#pragma once
#include <cstdint>
#include <vector>

#include "pbrt/math/vec.h"

namespace pbrt {

/// Permutation of 0 ... Size * Size - 1 over a tiling square of pixels, with similar ranks far apart (void and cluster,
/// Ulichney 1993): blue-noise thresholds.
class BlueNoiseMask {
  public:
    static constexpr int Log2Size = 6, Size = 1 << Log2Size;
    explicit BlueNoiseMask(uint64_t seed);
    uint32_t Rank(uint32_t x, uint32_t y) const { return ranks_[(y & (Size - 1)) << Log2Size | (x & (Size - 1))]; }

  private:
    std::vector<uint16_t> ranks_;
};

}  // namespace pbrt
