#pragma once
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "pbrt/math/lanes.h"
#include "pbrt/math/rng.h"

namespace pbrt {

/// Interleaves the bits of x (even) and y (odd).
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

/// Element i of the permutation of [0, n) selected by `seed`, without tables: cycle-walking with keyed bijections of
/// [0, m), m the next power of two (after Kensler 2013). Five rounds, because four leave correlations between elements
/// for small n (see the test).
/// T: uint64_t or lanes of it.
template <class T>
T PermutationElementOf(uint32_t i, uint32_t n, const T &seed) {
    const uint32_t mask = std::bit_ceil(n) - 1;
    const int bits = std::bit_width(mask), wide = (bits + 1) / 2, narrow = std::max(1, wide - 1);
    const T a = MixBits(seed ^ 0xa0761d6478bd642full), b = MixBits(seed + 0xe7037ed1a0b428dbull);
    T element = T{} + i, pending = ~T{};
    for (;;) {
        T next = element, add = a, multiply = b;
        for (int round = 0; round < 5; ++round) {
            next = ((next + (add >> 40)) * ((multiply >> 40) | 1)) & mask;
            next ^= next >> (round & 1 ? wide : narrow);
            add *= 0x9e3779b97f4a7c15ull;
            multiply *= 0xd1342543de82ef95ull;
        }
        next = (next + (add >> 40)) & mask;
        element = (next & pending) | (element & ~pending);
        if (mask == n - 1) return element;
        // negative in finished lanes
        pending = ((element - n) >> 63) - 1;
        if (!HasAnyBit(pending)) return element;
    }
}
inline uint32_t PermutationElement(uint32_t i, uint32_t n, uint64_t seed) {
    return uint32_t(PermutationElementOf(i, n, seed));
}

/// For each element of a quad, its positions in all 24 orders, two bits per order.
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

/// Position of an element (0 ... 3) in the order of four selected by a hash below 2^32, per lane.
inline Lanes64 PlaceInQuad(uint64_t element, const Lanes64 &hash) {
    return PlacesInQuads[element] >> (2 * (hash * 24 >> 32)) & 3;
}

inline constexpr int PrimeCount = 1000;
extern const std::array<uint16_t, PrimeCount> Primes;

/// Mirrors the digits of a in `base` at the radix point.
Float RadicalInverse(uint32_t base, uint64_t a);

/// The a < base^digits whose first `digits` mirrored digits, read as an integer, are `mirrored`.
uint64_t InverseRadicalInverse(uint64_t mirrored, uint32_t base, int digits);

/// Radical inverse with independent random permutations per digit, including the zeros after the last digit of a, down
/// to 2^-32.
Float PermutedRadicalInverse(uint32_t base, uint64_t a, uint64_t seed);

/// Owen scrambling: a digit's permutation also depends on all preceding digits.
Float OwenScrambledRadicalInverse(uint32_t base, uint64_t a, uint64_t seed);

/// Radical inverses in the first prime bases whose k-th digit d becomes (multiplier * d + r_k) mod base with random r_k
/// per digit, including trailing zeros down to 2^-32.
class DigitPermutations {
  public:
    /// Dimension d uses base Primes[d], multipliers[d] in [1, base) and seed SeedOf(seed, d).
    DigitPermutations(std::span<const uint32_t> multipliers, uint64_t seed);
    static uint64_t SeedOf(uint64_t seed, int dimension) { return Hash(seed, dimension); }
    /// Values of four dimensions from firstDimension on; those beyond the last dimension are undefined. a < 2^50.
    void RadicalInverses(int firstDimension, uint64_t a, Float values[Lanes64Count]) const;

  private:
    // Rows of one number per dimension, padded to whole vectors.
    size_t length_;
    std::vector<double> base_, inverseBase_, multiplier_;
    std::vector<double> shifts_;  ///< r_k: a row per digit
    std::vector<double> tails_;   ///< value of the permuted zeros from digit k on: a row per digit and one more
    std::vector<int> digits_;     ///< per dimension
};

}  // namespace pbrt
