#pragma once
#include <array>
#include <vector>

#include "pbrt/samplers/sampler.h"

namespace pbrt {

/// Permutation of 0 ... Size * Size - 1 over a tiling square of pixels, with similar ranks far apart (void and cluster,
/// Ulichney 1993): blue-noise thresholds.
class BlueNoiseMask {
  public:
    static constexpr int Log2Size = 6, Size = 1 << Log2Size;
    explicit BlueNoiseMask(uint64_t seed);
    uint32_t Rank(uint32_t x, uint32_t y) const { return ranks_[(y & (Size - 1)) << Log2Size | (x & (Size - 1))]; }

  private:
    std::vector<uint16_t> ranks_;
};

/// Point of the unit square as binary fractions: bit 31 is the first digit after the point.
struct BinaryPoint {
    uint32_t x = 0, y = 0;
};

/// First 2^log2Count points of a random progressive multi-jittered (0,2) sequence (Christensen, Kensler and Kilpatrick
/// 2018): in every aligned run of 2^m points, each box of any cut into 2^a columns and 2^(m-a) rows holds one. The
/// first 16, 64, ... 4^blueLevels points have blue noise, also across the square's borders. An Owen scrambling of
/// Sobol' points: any flips give a (0,2) sequence, so random flips are optimised for blue noise digit by digit (after
/// Perrier et al. 2018).
std::vector<BinaryPoint> MakePmj02bn(int log2Count, int blueLevels, uint64_t seed);

/// Progressive multi-jittered (0,2) points. Positions of all samples in a square of pixels are one blue-noise point
/// set. For other dimensions a pixel uses one of a few fixed sets, in a random order that keeps runs of 4, 16, ...
/// samples together. Digits are flipped by masks with blue noise over the image, which preserves the (0,2) property.
class Pmj02bnSampler final : public SamplerBySettings<Pmj02bnSampler> {
  public:
    explicit Pmj02bnSampler(const SamplerSettings &settings);
    Point2 GetPixel2D() override;

    /// 2^SetLog2Count points per set; the first set is for positions. Built at the first call.
    static constexpr int SetCount = 6, SetLog2Count = 16;
    static const std::vector<BinaryPoint> &Set(int index);

  protected:
    int StartSample(Point2i pixel, int sampleIndex, int dimension) override;
    Run Prepare(int dimension, Numbers &numbers) override;

  private:
    /// For eight dimensions from the given one: indices into the sets, and flip masks.
    Lanes64 PlacesFor(int dimension) const;
    Lanes64 FlipsFor(int dimension) const;

    std::array<const BinaryPoint *, SetCount> sets_;
    const BlueNoiseMask *mask_;
    int log2Samples_;  ///< log2 of the samples per pixel, rounded up
    uint64_t seed_;
    int log2Tile_;                                                 ///< side of a tile in pixels
    int log2PerPixel_;                                             ///< points of a tile per pixel
    std::shared_ptr<const std::vector<BinaryPoint>> pixelPoints_;  ///< of a tile, by pixel, as fractions of the pixel
    Point2i pixel_{};
    int index_ = 0;
    uint64_t pixelHash_ = 0, setHash_ = 0;
};

}  // namespace pbrt
