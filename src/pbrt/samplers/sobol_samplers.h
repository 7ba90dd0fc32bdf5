#pragma once
#include <array>
#include <vector>

#include "pbrt/math/sobol.h"
#include "pbrt/samplers/sampler.h"

namespace pbrt {

/// Seeds of four dimensions from `first` on for a hashed state.
inline Lanes64 AddDimensions(uint64_t hash, int first) {
    return MixBits(hash + 0x9e3779b97f4a7c15ull * (CountingLanes(uint64_t(first)) + 1));
}

/// 64 bits for each lane of a Lanes32.
struct WideLanes {
    Lanes64 a, b;
    Lanes32 Low() const { return LowHalves(a, b); }
    Lanes32 High() const { return LowHalves(a >> 32, b >> 32); }
};

/// One coordinate of eight points, from bit-reversed values.
inline FloatLanes RandomizedReversed(const Lanes32 &reversed, Randomization randomization, const WideLanes &seeds) {
    switch (randomization) {
        case Randomization::FastOwen:
            return FractionsToFloat(ReverseBits(FastOwenScrambleReversed(reversed, seeds.Low(), seeds.High())));
        case Randomization::Owen: {
            const auto pairs = reinterpret_cast<Lanes64>(ReverseBits(reversed));  // in even and odd places
            const Lanes64 even = __builtin_shufflevector(seeds.a, seeds.b, 0, 2, 4, 6);
            const Lanes64 odd = __builtin_shufflevector(seeds.a, seeds.b, 1, 3, 5, 7);
            const Lanes64 scrambledEven = OwenScramble(pairs & 0xffffffffull, even);
            const Lanes64 scrambledOdd = OwenScramble(pairs >> 32, odd);
            return FractionsToFloat(reinterpret_cast<Lanes32>(scrambledEven | scrambledOdd << 32));
        }
        case Randomization::PermuteDigits: return FractionsToFloat(ReverseBits(reversed ^ seeds.Low()));
        default: return FractionsToFloat(ReverseBits(reversed));
    }
}

/// Seed of the second coordinate. A full hash, because the low bits of a product would depend on those of the first
/// seed.
inline WideLanes SecondSeed(const WideLanes &seed) {
    return {MixBits(seed.a ^ 0x632be59bd9b4e019ull), MixBits(seed.b ^ 0x632be59bd9b4e019ull)};
}

inline int Log2RoundedUp(int v) { return std::bit_width(unsigned(std::max(1, v)) - 1); }

inline void SetSobolPoints(const WideLanes &index, Randomization randomization, const WideLanes &seedX,
                           const WideLanes &seedY, FloatLanes *x, FloatLanes *y) {
    const Lanes32 low = index.Low();
    *x = RandomizedReversed(low, randomization, seedX);
    const Lanes32 second = SobolReversed1OfHalf(low) ^ SobolReversed1OfHalf(index.High());
    *y = RandomizedReversed(second, randomization, seedY);
}

/// Global Sobol' sequence: its first two dimensions cover the film (up to a power of two), so that pixels share one
/// high-dimensional point set. These two are not randomised, the others are.
class SobolSampler final : public SamplerBySettings<SobolSampler> {
  public:
    explicit SobolSampler(const SamplerSettings &settings)
        : SamplerBySettings(settings), seed_(Hash(settings.seed)),
          log2Resolution_(Log2RoundedUp(std::max(settings.resolution.x, settings.resolution.y))),
          pixelIndex_(std::make_shared<const SobolPixelIndex>(log2Resolution_)), tables_(SobolTables()) {
        if (2 * log2Resolution_ + Log2RoundedUp(settings.samplesPerPixel) > SobolIndexBits)
            throw UserError("{} samples per pixel of {} x {} pixels exceed the 2^{} points of this sampler.",
                            settings.samplesPerPixel, settings.resolution.x, settings.resolution.y, SobolIndexBits);
        auto seeds = std::make_shared<std::vector<uint64_t>>(SobolTableRow);
        for (int d = 0; d < SobolTableRow; d += Lanes64Count) StoreLanes(AddDimensions(seed_, d), &(*seeds)[d]);
        seeds_ = std::move(seeds);
    }
    Point2 GetPixel2D() override {
        // Fraction of each coordinate after the pixel's digits.
        return {SobolToFloat(SobolBitsByTable(tables_, index_) << log2Resolution_),
                SobolToFloat(SobolBitsByTable(tables_ + 1, index_) << log2Resolution_)};
    }
    uint64_t Index() const { return index_; }

  protected:
    int StartSample(Point2i pixel, int sampleIndex, int dimension) override {
        uint32_t mask = (1u << log2Resolution_) - 1;
        const uint64_t frame = settings_.firstSample + uint64_t(sampleIndex);
        index_ = (*pixelIndex_)(frame, uint32_t(pixel.x) & mask, uint32_t(pixel.y) & mask);
        return std::max(2, dimension);
    }
    Run Prepare(int dimension, Numbers &numbers) override {
        FloatLanes values{};
        if (dimension < SobolDimensions) values = EightDimensions(dimension);
        for (int d = std::max(dimension, SobolDimensions); d < dimension + kPrepared; ++d) {
            const uint64_t seed = MixBits(seed_ + 0x9e3779b97f4a7c15ull * uint64_t(d + 1));
            values[d - dimension] = HashToFloat(MixBits(seed ^ MixBits(index_)));
        }
        numbers.SetSequence(values);
        return {dimension, kPrepared - 1};
    }

  private:
    FloatLanes EightDimensions(int first) const {
        Lanes32 v{};
        const uint32_t *rows = tables_ + first;
        for (uint64_t bits = index_; bits; bits >>= 4, rows += 16 * SobolTableRow)
            v ^= LoadLanes<Lanes32>(rows + (bits & 15) * SobolTableRow);
        const uint64_t *seeds = seeds_->data() + first;
        const WideLanes seed{LoadLanes<Lanes64>(seeds), LoadLanes<Lanes64>(seeds + Lanes64Count)};
        if (settings_.randomization == Randomization::PermuteDigits) return FractionsToFloat(v ^ seed.Low());
        return RandomizedReversed(ReverseBits(v), settings_.randomization, seed);
    }
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
    int StartSample(Point2i pixel, int sampleIndex, int dimension) override {
        int round = sampleIndex / SamplesPerPixel();
        index_ = uint32_t(sampleIndex - round * SamplesPerPixel());
        pixelHash_ = Hash(pixel, settings_.seed, round);
        return dimension;
    }
    Run Prepare(int dimension, Numbers &numbers) override {
        const WideLanes seed{AddDimensions(pixelHash_, dimension), AddDimensions(pixelHash_, dimension + Lanes64Count)};
        const auto count = uint32_t(SamplesPerPixel());
        FloatLanes x, y;
        SetSobolPoints({PermutationElementOf(index_, count, seed.a), PermutationElementOf(index_, count, seed.b)},
                       settings_.randomization, seed, SecondSeed(seed), &x, &y);
        numbers.SetPoints(x, y);
        return {dimension, kPrepared};
    }

  private:
    uint64_t pixelHash_ = 0;
    uint32_t index_ = 0;
};

/// Blue-noise error by ordering (Ahmed and Wonka 2020): pixels in Morton order take consecutive pieces of one Sobol'
/// sequence, with the children of every quad in a random order per dimension.
class ZSobolSampler final : public SamplerBySettings<ZSobolSampler> {
  public:
    explicit ZSobolSampler(const SamplerSettings &settings)
        : SamplerBySettings(settings), seed_(Hash(settings.seed)),
          log2Samples_(Log2RoundedUp(settings.samplesPerPixel)),
          indexBits_(log2Samples_ + 2 * Log2RoundedUp(std::max(settings.resolution.x, settings.resolution.y))) {}

  protected:
    int StartSample(Point2i pixel, int sampleIndex, int dimension) override {
        int round = sampleIndex / SamplesPerPixel();
        if (pixel != pixel_ || round != round_) {
            if (round != round_) BeginRound(round);
            pixel_ = pixel;
            pixelPartKnown_ = 0;
            pixelMorton_ = EncodeMorton2(uint32_t(pixel.x), uint32_t(pixel.y)) << log2Samples_;
        }
        morton_ = pixelMorton_ | uint64_t(sampleIndex - round * SamplesPerPixel());
        return dimension;
    }
    Run Prepare(int dimension, Numbers &numbers) override {
        // Runs are aligned to their length, so that pixelPart_ is filled by whole vectors.
        const int first = dimension - dimension % kPrepared;
        const Seeds seeds = first < kRemembered ? roundSeeds_[first / kPrepared] : SeedsOf(first);
        FloatLanes x, y;
        SetSobolPoints({SobolIndices(first, seeds.order.a), SobolIndices(first + Lanes64Count, seeds.order.b)},
                       settings_.randomization, seeds.x, seeds.y, &x, &y);
        numbers.SetPoints(x, y);
        return {first, kPrepared};
    }

  private:
    /// Of kPrepared dimensions, the same in all pixels.
    struct Seeds {
        WideLanes order, x, y;
    };
    void BeginRound(int round) {
        round_ = round;
        for (int i = 0; i < kRemembered / kPrepared; ++i) roundSeeds_[i] = SeedsOf(i * kPrepared);
    }
    Seeds SeedsOf(int first) const {
        const uint64_t hash = seed_ + uint64_t(round_) * 0xbf58476d1ce4e5b9ull;
        const WideLanes order{AddDimensions(hash, first), AddDimensions(hash, first + Lanes64Count)};
        const WideLanes x = SecondSeed(order);
        return {order, x, SecondSeed(x)};
    }
    /// Sobol' indices for four dimensions from firstDimension on, given their hashes.
    Lanes64 SobolIndices(int firstDimension, const Lanes64 &hash) {
        // Quads down to the pixel are common to all its samples.
        Lanes64 index;
        if (firstDimension < kRemembered) {
            const uint32_t known = 1u << (firstDimension / Lanes64Count);
            uint64_t *const part = &pixelPart_[firstDimension];
            if (!(pixelPartKnown_ & known)) {
                StoreLanes(PermutedQuads(hash, log2Samples_, indexBits_), part);
                pixelPartKnown_ |= known;
            }
            index = LoadLanes<Lanes64>(part);
        } else {
            index = PermutedQuads(hash, log2Samples_, indexBits_);
        }
        // Below the pixel, quads group its samples; with an odd number of bits, the last bit is a pair in random order.
        int lone = log2Samples_ & 1;
        if (lone) index |= (morton_ & 1) ^ (MixBits(hash ^ (morton_ >> 1)) >> 63);
        return index | PermutedQuads(hash, lone, log2Samples_);
    }
    /// Bits fromBit ... toBit - 1 of morton_, with the children of every quad in the order selected by (hash, quad).
    Lanes64 PermutedQuads(const Lanes64 &hash, int fromBit, int toBit) const {
        Lanes64 index{};
        Lanes64 level = hash + 0x9e3779b97f4a7c15ull * uint64_t(fromBit / 2);
        for (int shift = fromBit; shift < toBit; shift += 2) {
            level += 0x9e3779b97f4a7c15ull;
            Lanes64 quad = (level ^ (morton_ >> (shift + 2))) * 0x7fb5d329728ea185ull;
            quad = ((quad ^ (quad >> 32)) * 0x81dadef4bc2dd44dull) >> 32;
            index |= PlaceInQuad(morton_ >> shift & 3, quad) << shift;
        }
        return index;
    }
    static constexpr int kRemembered = 128;
    uint64_t seed_;
    int log2Samples_;  ///< log2 of the samples per pixel, rounded up
    int indexBits_;    ///< of morton_
    Point2i pixel_{-1, -1};
    int round_ = -1;
    uint64_t pixelMorton_ = 0;  ///< Morton index of the pixel, above the bits of the sample index
    uint64_t morton_ = 0;       ///< pixelMorton_ with the sample index
    /// High bits of SobolIndices, by dimension, and which are cached: one bit per four dimensions.
    uint32_t pixelPartKnown_ = 0;
    std::array<uint64_t, kRemembered> pixelPart_{};
    std::array<Seeds, kRemembered / kPrepared> roundSeeds_{};  ///< of the first dimensions
};

}  // namespace pbrt
