#pragma once
#include <array>
#include <bit>
#include <cstdint>

#include "pbrt/math/lanes.h"
#include "pbrt/math/low_discrepancy.h"

namespace pbrt {

// Sobol' points as 32-bit binary fractions: bit 31 is the first digit after the point.

inline constexpr int SobolDimensions = 1024;
inline constexpr int SobolIndexBits = 52;

/// Generator matrices of Joe and Kuo (2008) from Boost: column c of dimension d, at [d * SobolIndexBits + c], is the
/// point of index 2^c. Built at the first call; keep the pointer in hot code.
const uint32_t *SobolMatrices();

/// One coordinate; `matrix` points to the columns of its dimension.
inline uint32_t SobolBits(const uint32_t *matrix, uint64_t index) {
    uint32_t v = 0;
    for (; index; index &= index - 1) v ^= matrix[std::countr_zero(index)];
    return v;
}

/// Tables for four index bits at a time: per group of bits and each of its 16 values, a row with the entries of all
/// dimensions (0.8 MB, built at the first call). Rows are padded so that lanes may be read from any dimension on.
inline constexpr int SobolTableRow = SobolDimensions + Lanes32Count;
const uint32_t *SobolTables();
/// One coordinate; `table` points to the dimension's column in the first row.
inline uint32_t SobolBitsByTable(const uint32_t *table, uint64_t index) {
    uint32_t v = 0;
    for (; index; index >>= 4, table += 16 * SobolTableRow) v ^= table[(index & 15) * SobolTableRow];
    return v;
}

/// The first two coordinates, bit-reversed. The first matrix is the mirrored identity. The second, mirrored, is
/// Pascal's triangle mod 2: a Kronecker power of (1 1; 0 1), applied factor by factor.
constexpr uint32_t SobolReversed0(uint64_t index) { return uint32_t(index); }
/// T: uint32_t or lanes of it.
template <class T>
constexpr T SobolReversed1OfHalf(T v) {
    v ^= (v & 0xaaaaaaaau) >> 1;
    v ^= (v & 0xccccccccu) >> 2;
    v ^= (v & 0xf0f0f0f0u) >> 4;
    v ^= (v & 0xff00ff00u) >> 8;
    v ^= (v & 0xffff0000u) >> 16;
    return v;
}
constexpr uint32_t SobolReversed1(uint64_t index) {
    return SobolReversed1OfHalf(uint32_t(index)) ^ SobolReversed1OfHalf(uint32_t(index >> 32));
}

inline Float SobolToFloat(uint32_t v) { return std::min(Float(v) * 0x1p-32f, OneMinusEpsilon); }

/// Flip of a node in the binary digit tree, by hash: 0 or 1. T: uint64_t or lanes of it.
template <class T>
inline T OwenFlip(const T &seed, const T &node) {
    T hash = (seed + node * 0x9e3779b97f4a7c15ull) * 0x7fb5d329728ea185ull;
    hash ^= hash >> 32;
    return hash * 0x81dadef4bc2dd44dull >> 63;
}
/// Owen's nested uniform scrambling of a 32-bit number: every digit is flipped by a hash of the preceding digits.
template <class T>
inline T OwenScrambleOf(const T &v, const T &seed) {
    T flips{};
    for (int digit = 0; digit < 32; ++digit) {
        const T node = (v | uint64_t(1) << 32) >> (32 - digit);  // node in the tree, root = 1
        flips |= OwenFlip(seed, node) << (31 - digit);
    }
    return v ^ flips;
}
inline uint32_t OwenScramble(uint32_t v, uint64_t seed) { return uint32_t(OwenScrambleOf<uint64_t>(v, seed)); }
inline Lanes64 OwenScramble(const Lanes64 &v, const Lanes64 &seed) { return OwenScrambleOf(v, seed); }

/// Nested uniform scrambling of bit-reversed numbers with one hash (Laine and Karras 2011). Addition, odd
/// multiplication and v ^= v * even change a bit depending only on lower bits, which are the earlier digits. T:
/// uint32_t or lanes of it; `low` and `high` are the halves of the seed.
template <class T>
inline T FastOwenScrambleReversed(T v, T low, T high) {
    v += low;
    v ^= v * 0x6a09e66eu;
    v *= high | 1u;
    v ^= v * 0xbb67ae86u;
    v += high ^ (low << 13 | low >> 19);
    v *= (low << 16 | low >> 16) | 1u;
    v ^= v * 0x3c6ef372u;
    return v;
}
inline uint32_t FastOwenScrambleReversed(uint32_t v, uint64_t seed) {
    return FastOwenScrambleReversed<uint32_t>(v, uint32_t(seed), uint32_t(seed >> 32));
}

/// Enumerates the points of the global Sobol' sequence in a pixel of a 2^m x 2^m image covered by the first two
/// dimensions. Each aligned run of 4^m points has one point per pixel.
class SobolPixelIndex {
  public:
    explicit SobolPixelIndex(int log2Resolution);
    /// Index of the `frame`-th point in the pixel; 0 <= x, y < 2^m. Frames repeat after 2^SobolIndexBits points.
    uint64_t operator()(uint64_t frame, uint32_t x, uint32_t y) const {
        uint64_t low = 0;
        frame &= (uint64_t(1) << (SobolIndexBits - 2 * log2Resolution_)) - 1;
        for (uint64_t bits = frame; bits; bits &= bits - 1) low ^= frameColumns_[IndexOf(bits)];
        for (uint64_t bits = x | uint64_t(y) << log2Resolution_; bits; bits &= bits - 1)
            low ^= pixelColumns_[IndexOf(bits)];
        return frame << (2 * log2Resolution_) | low;
    }

  private:
    static size_t IndexOf(uint64_t bits) { return size_t(std::countr_zero(bits)); }
    int log2Resolution_;
    std::array<uint64_t, SobolIndexBits> pixelColumns_{};  ///< low index bits for each bit of (y << m | x)
    std::array<uint64_t, 64> frameColumns_{};              ///< low index bits that cancel the effect of frame bits on
                                                           ///< the pixel
};

}  // namespace pbrt
