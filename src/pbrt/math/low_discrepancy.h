#pragma once
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "pbrt/math/lanes.h"
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

/// PermutationElement(i, n, seed) for every lane of `seed`.
inline Lanes64 PermutationElement(uint32_t i, uint32_t n, const Lanes64 &seed) {
    const uint32_t mask = std::bit_ceil(n) - 1;
    const int bits = std::bit_width(mask), wide = (bits + 1) / 2, narrow = std::max(1, wide - 1);
    const Lanes64 a = MixBits(seed ^ 0xa0761d6478bd642full), b = MixBits(seed + 0xe7037ed1a0b428dbull);
    Lanes64 element = Lanes64{} + i, pending = ~Lanes64{};
    for (;;) {
        Lanes64 next = element, add = a, multiply = b;
        for (int round = 0; round < 5; ++round) {
            next = ((next + (add >> 40)) * ((multiply >> 40) | 1)) & mask;
            next ^= next >> (round & 1 ? wide : narrow);
            add *= 0x9e3779b97f4a7c15ull;
            multiply *= 0xd1342543de82ef95ull;
        }
        next = (next + (add >> 40)) & mask;
        element = (next & pending) | (element & ~pending);
        if (mask == n - 1) return element;
        // The difference is negative in the lanes that are done.
        pending = ((element - n) >> 63) - 1;
        uint64_t any = 0;
        for (int lane = 0; lane < Lanes64Count; ++lane) any |= pending[lane];
        if (!any) return element;
    }
}

/// For each of the four elements of a quad the places that it has in all 24 orders, two bits for each order.
constexpr std::array<uint64_t, 4> AllPlacesInQuads() {
    std::array<uint64_t, 4> places{};
    int n = 0;
    for (unsigned a = 0; a < 4; ++a)
        for (unsigned b = 0; b < 4; ++b)
            for (unsigned c = 0; c < 4; ++c)
                if (a != b && a != c && b != c) {
                    const unsigned order[4] = {a, b, c, 6 - a - b - c};
                    for (size_t element = 0; element < 4; ++element) places[element] |= uint64_t(order[element]) << n;
                    n += 2;
                }
    return places;
}
inline constexpr std::array<uint64_t, 4> PlacesInQuads = AllPlacesInQuads();

/// Where an element (0 ... 3) is in the order of four that a hash below 2^32 picks in each lane.
inline Lanes64 PlaceInQuad(uint64_t element, const Lanes64 &hash) {
    return PlacesInQuads[element] >> (2 * (hash * 24 >> 32)) & 3;
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
    /// RadicalInverse for eight dimensions from firstDimension < Dimensions() on; what lies beyond the last dimension
    /// is undefined. a < 2^50.
    void RadicalInverses(int firstDimension, uint64_t a, Float values[Lanes64Count]) const;

  private:
    /// For RadicalInverses: a row holds one number for every dimension, and a few for lanes beyond the last.
    struct Rows {
        size_t length = 0;
        std::vector<double> base, inverseBase, multiplier;
        std::vector<double> shifts;  ///< a row for every digit
        std::vector<double> tails;   ///< tails_, a row for every digit and one more
    };
    void MakeRows(std::span<const uint32_t> multipliers);
    struct Base {
        uint32_t base = 0;
        int digits = 0;
        size_t first = 0;      ///< into permutations_: digits * base entries
        size_t firstTail = 0;  ///< into tails_: digits + 1 entries
    };
    std::vector<Base> bases_;
    std::vector<uint16_t> permutations_;
    std::vector<double> tails_;  ///< value of the permuted zeros from digit k on
    Rows rows_;
};

}  // namespace pbrt
