#pragma once
#include "pbrt/math/sobol.h"

namespace pbrt {

/// How low-discrepancy points are made random without losing their stratification.
enum class Randomization { None, PermuteDigits, FastOwen, Owen };

/// Randomizes one coordinate of a Sobol' point, whose bits are in reversed order.
inline Float RandomizedReversed(uint32_t reversed, Randomization randomization, uint64_t seed) {
    switch (randomization) {
        case Randomization::FastOwen:
            return SobolToFloat(ReverseBits32(FastOwenScrambleReversed(reversed, seed)));
        case Randomization::Owen:
            return SobolToFloat(OwenScramble(ReverseBits32(reversed), seed));
        case Randomization::PermuteDigits:
            return SobolToFloat(ReverseBits32(reversed ^ static_cast<uint32_t>(seed)));
        default:
            return SobolToFloat(ReverseBits32(reversed));
    }
}
inline Float Randomized(uint32_t bits, Randomization randomization, uint64_t seed) {
    switch (randomization) {
        case Randomization::FastOwen:
            return SobolToFloat(FastOwenScramble(bits, seed));
        case Randomization::Owen:
            return SobolToFloat(OwenScramble(bits, seed));
        case Randomization::PermuteDigits:
            return SobolToFloat(bits ^ static_cast<uint32_t>(seed));
        default:
            return SobolToFloat(bits);
    }
}

}  // namespace pbrt
