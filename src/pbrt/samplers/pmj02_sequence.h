#pragma once
#include <cstdint>
#include <vector>

namespace pbrt {

/// Point of the unit square as binary fractions: bit 31 is the first digit after the point.
struct BinaryPoint {
    uint32_t x = 0, y = 0;
};

/// First 2^log2Count points of a random progressive multi-jittered (0,2) sequence (Christensen, Kensler and Kilpatrick
/// 2018): in every aligned run of 2^m points, each box of any cut into 2^a columns and 2^(m-a) rows holds one. The
/// first 16, 64, ... 4^blueLevels points have blue noise, also across the square's borders. An Owen scrambling of
/// Sobol' points: any flips give a (0,2) sequence, so random flips are optimised for blue noise digit by digit (after
/// Perrier et al. 2018).
std::vector<BinaryPoint> MakePmj02bn(int log2Count, int blueLevels, uint64_t seed);

}  // namespace pbrt
