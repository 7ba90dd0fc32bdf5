#pragma once
#include <array>
#include <vector>

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

/// Global Sobol' sequence: its first two dimensions cover the film (up to a power of two), so that pixels share one
/// high-dimensional point set. These two are not randomised, the others are.
class SobolSampler final : public SamplerBySettings<SobolSampler> {
  public:
    explicit SobolSampler(const SamplerSettings &settings);
    Point2 GetPixel2D() override;
    uint64_t Index() const { return index_; }

  protected:
    int StartSample(Point2i pixel, int sampleIndex, int dimension) override;
    Run Prepare(int dimension, Numbers &numbers) override;

  private:
    FloatLanes SixteenDimensions(int first) const;
    uint64_t seed_;
    int log2Resolution_;
    std::shared_ptr<const SobolPixelIndex> pixelIndex_;
    std::shared_ptr<const std::vector<uint64_t>> seeds_;  ///< of SobolTableRow dimensions
    const uint32_t *tables_;
    uint64_t index_ = 0;
};

/// Each request uses the first one or two Sobol' dimensions, with independent random order and randomisation per
/// request and pixel.
class PaddedSobolSampler final : public SamplerBySettings<PaddedSobolSampler> {
  public:
    using SamplerBySettings::SamplerBySettings;

  protected:
    int StartSample(Point2i pixel, int sampleIndex, int dimension) override;
    Run Prepare(int dimension, Numbers &numbers) override;

  private:
    uint64_t pixelHash_ = 0;
    uint32_t index_ = 0;
};

/// Blue-noise error by ordering (Ahmed and Wonka 2020): pixels in Morton order take consecutive pieces of one Sobol'
/// sequence, with the children of every quad in a random order per dimension.
class ZSobolSampler final : public SamplerBySettings<ZSobolSampler> {
  public:
    explicit ZSobolSampler(const SamplerSettings &settings);

  protected:
    int StartSample(Point2i pixel, int sampleIndex, int dimension) override;
    Run Prepare(int dimension, Numbers &numbers) override;

  private:
    /// Sobol' indices for eight dimensions from firstDimension on, given their hashes.
    Lanes64 SobolIndices(int firstDimension, const Lanes64 &hash);
    /// Bits fromBit ... toBit - 1 of morton_, with the children of every quad in the order selected by (hash, quad).
    Lanes64 PermutedQuads(const Lanes64 &hash, int fromBit, int toBit) const;
    static constexpr int kRemembered = 128;
    uint64_t seed_;
    int log2Samples_;  ///< log2 of the samples per pixel, rounded up
    int indexBits_;    ///< of morton_
    Point2i pixel_{-1, -1};
    int round_ = -1;
    uint64_t roundSeed_ = 0;
    uint64_t pixelMorton_ = 0;  ///< Morton index of the pixel, above the bits of the sample index
    uint64_t morton_ = 0;       ///< pixelMorton_ with the sample index
    /// High bits of SobolIndices, by dimension, and which are cached: one bit per eight dimensions.
    uint32_t pixelPartKnown_ = 0;
    std::array<uint64_t, kRemembered> pixelPart_{};
};

}  // namespace pbrt
