#pragma once
#include <array>
#include <vector>

#include "pbrt/math/sobol.h"
#include "pbrt/samplers/randomization.h"
#include "pbrt/samplers/sampler.h"

namespace pbrt {

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
    /// Seeds of the dimensions, in halves; SobolTableRow of each.
    struct Seeds {
        std::vector<uint32_t> low, high;
    };
    FloatLanes SixteenDimensions(int first) const;
    uint64_t seed_;
    int log2Resolution_;
    std::shared_ptr<const SobolPixelIndex> pixelIndex_;
    std::shared_ptr<const Seeds> seeds_;
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
