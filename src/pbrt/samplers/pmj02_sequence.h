#pragma once
#include <cstdint>
#include <vector>

namespace pbrt {

/// A point of the unit square as binary fractions: bit 31 is the first digit after the point.
struct BinaryPoint {
    uint32_t x = 0, y = 0;
};

/// The first 2^log2Count points of a random progressive multi-jittered (0,2) sequence (Christensen, Kensler and
/// Kilpatrick 2018): of every aligned run of 2^m points, each of the 2^m boxes of any cut into 2^a columns and 2^(m-a)
/// rows holds one. The first 16, 64, ... 4^blueLevels points also keep away from each other, across the borders of the
/// square too. Made as Owen's scrambling of Sobol's points: any flips give a (0,2) sequence, so that they are first
/// drawn at random and then optimized for blue noise digit by digit (in the way of Perrier et al. 2018).
std::vector<BinaryPoint> MakePmj02bn(int log2Count, int blueLevels, uint64_t seed);

}  // namespace pbrt
