#pragma once
#include <cstdint>
#include <vector>

#include "pbrt/math/vec.h"

namespace pbrt {

/// The numbers 0 ... Size * Size - 1 in a square of pixels that tiles the plane; similar numbers are far from each
/// other (void and cluster, Ulichney 1993): thresholds with blue noise.
class BlueNoiseMask {
  public:
    static constexpr int Log2Size = 6, Size = 1 << Log2Size;
    explicit BlueNoiseMask(uint64_t seed);
    uint32_t Rank(uint32_t x, uint32_t y) const { return ranks_[(y & (Size - 1)) << Log2Size | (x & (Size - 1))]; }

  private:
    std::vector<uint16_t> ranks_;
};

}  // namespace pbrt
