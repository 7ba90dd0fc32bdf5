#pragma once
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "pbrt/math/rng.h"

namespace pbrt {

// ---- Bits

constexpr uint32_t ReverseBits32(uint32_t v) {
    v = ((v & 0x55555555u) << 1) | ((v >> 1) & 0x55555555u);
    v = ((v & 0x33333333u) << 2) | ((v >> 2) & 0x33333333u);
    v = ((v & 0x0f0f0f0fu) << 4) | ((v >> 4) & 0x0f0f0f0fu);
    return __builtin_bswap32(v);
}

/// Interleaves the bits of x (even places) and y (odd places).
constexpr uint64_t EncodeMorton2(uint32_t x, uint32_t y) {
    auto spread = [](uint32_t v) {
        uint64_t s = v;
        s = (s | (s << 16)) & 0x0000ffff0000ffffull;
        s = (s | (s << 8)) & 0x00ff00ff00ff00ffull;
        s = (s | (s << 4)) & 0x0f0f0f0f0f0f0f0full;
        s = (s | (s << 2)) & 0x3333333333333333ull;
        s = (s | (s << 1)) & 0x5555555555555555ull;
        return s;
    };
    return spread(x) | (spread(y) << 1);
}

// ---- Permutations

/// Element i of the permutation of [0, n) that `seed` selects, computed without a table: rounds of keyed bijections of
/// [0, m), where m is the smallest power of two that is at least n, repeated until the result is below n (the idea of
/// Kensler 2013). There are five rounds, because with four, pairs of elements of small n visibly prefer some places
/// (see the test).
inline uint32_t PermutationElement(uint32_t i, uint32_t n, uint64_t seed) {
    uint32_t mask = std::bit_ceil(n) - 1;
    int bits = std::bit_width(mask), wide = (bits + 1) / 2, narrow = std::max(1, wide - 1);
    uint64_t a = MixBits(seed ^ 0xa0761d6478bd642full), b = MixBits(seed + 0xe7037ed1a0b428dbull);
    do {
        uint64_t add = a, multiply = b;
        for (int round = 0; round < 5; ++round) {
            i = ((i + static_cast<uint32_t>(add >> 40)) * (static_cast<uint32_t>(multiply >> 40) | 1)) & mask;
            i ^= i >> (round & 1 ? wide : narrow);
            add *= 0x9e3779b97f4a7c15ull;
            multiply *= 0xd1342543de82ef95ull;
        }
        i = (i + static_cast<uint32_t>(add >> 40)) & mask;
    } while (i >= n);
    return i;
}

// ---- Radical inverses (van der Corput, Halton)

inline constexpr int PrimeCount = 1000;
/// The first primes: 2, 3, 5, ..., 7919.
extern const std::array<uint16_t, PrimeCount> Primes;

/// The digits of a in `base`, mirrored at the radix point.
Float RadicalInverse(uint32_t base, uint64_t a);

/// The a < base^digits whose first `digits` mirrored digits, read as an integer, are `mirrored`.
uint64_t InverseRadicalInverse(uint64_t mirrored, uint32_t base, int digits);

/// Radical inverse with an independent random permutation for every digit position, which also permutes the zeros that
/// follow the last digit of a, down to 2^-32.
Float PermutedRadicalInverse(uint32_t base, uint64_t a, uint64_t seed);

/// Owen scrambling: the permutation of a digit depends also on all digits before it.
Float OwenScrambledRadicalInverse(uint32_t base, uint64_t a, uint64_t seed);

/// Radical inverse whose k-th digit d becomes multiplier * d + r_k modulo `base`, with a random r_k for every digit; so
/// do the zeros that follow the last digit of a, down to 2^-32. 0 < multiplier < base, and base is prime.
Float AffineRadicalInverse(uint32_t base, uint64_t a, uint32_t multiplier, uint64_t seed);

/// AffineRadicalInverse for the first prime bases with the permutations in tables: it gives the same values faster.
class DigitPermutations {
  public:
    /// Dimension d has the base Primes[d], multipliers[d] and the seed SeedOf(seed, d).
    DigitPermutations(std::span<const uint32_t> multipliers, uint64_t seed);
    static uint64_t SeedOf(uint64_t seed, int dimension) { return Hash(seed, dimension); }
    int Dimensions() const { return static_cast<int>(bases_.size()); }
    Float RadicalInverse(int dimension, uint64_t a) const;

  private:
    struct Base {
        uint32_t base = 0;
        int digits = 0;
        size_t first = 0;      ///< into permutations_: digits * base entries
        size_t firstTail = 0;  ///< into tails_: digits + 1 entries
    };
    std::vector<Base> bases_;
    std::vector<uint16_t> permutations_;
    std::vector<double> tails_;  ///< value of the permuted zeros from digit k on
};

}  // namespace pbrt
