#pragma once
#include "pbrt/math/sobol.h"
#include "pbrt/samplers/sampler.h"

namespace pbrt {

/// Seeds of eight dimensions from `first` on for a hashed state.
inline Lanes64 AddDimensions(uint64_t hash, int first) {
    return MixBits(hash + 0x9e3779b97f4a7c15ull * (CountingLanes(uint64_t(first)) + 1));
}

struct SixteenLanes {
    Lanes64 a, b;
    Lanes32 Low() const { return LowHalves(a, b); }
    Lanes32 High() const { return LowHalves(a >> 32, b >> 32); }
};

/// One coordinate of sixteen points, from bit-reversed values.
inline FloatLanes RandomizedReversed(const Lanes32 &reversed, Randomization randomization, const SixteenLanes &seeds) {
    switch (randomization) {
        case Randomization::FastOwen:
            return FractionsToFloat(ReverseBits(FastOwenScrambleReversed(reversed, seeds.Low(), seeds.High())));
        case Randomization::Owen: {
            const auto pairs = reinterpret_cast<Lanes64>(ReverseBits(reversed));  // in even and odd places
            const auto low = reinterpret_cast<Lanes32>(seeds.a), high = reinterpret_cast<Lanes32>(seeds.b);
            const Lanes32 even =
                __builtin_shufflevector(low, high, 0, 1, 4, 5, 8, 9, 12, 13, 16, 17, 20, 21, 24, 25, 28, 29);
            const Lanes32 odd =
                __builtin_shufflevector(low, high, 2, 3, 6, 7, 10, 11, 14, 15, 18, 19, 22, 23, 26, 27, 30, 31);
            const Lanes64 scrambledEven = OwenScramble(pairs & 0xffffffffull, reinterpret_cast<Lanes64>(even));
            const Lanes64 scrambledOdd = OwenScramble(pairs >> 32, reinterpret_cast<Lanes64>(odd));
            return FractionsToFloat(reinterpret_cast<Lanes32>(scrambledEven | scrambledOdd << 32));
        }
        case Randomization::PermuteDigits: return FractionsToFloat(ReverseBits(reversed ^ seeds.Low()));
        default: return FractionsToFloat(ReverseBits(reversed));
    }
}

/// Seed of the second coordinate. A full hash, because the low bits of a product would depend on those of the first
/// seed.
inline SixteenLanes SecondSeed(const SixteenLanes &seed) {
    return {MixBits(seed.a ^ 0x632be59bd9b4e019ull), MixBits(seed.b ^ 0x632be59bd9b4e019ull)};
}

}  // namespace pbrt
