#pragma once
#include <array>

#include "pbrt/samplers/blue_noise_mask.h"
#include "pbrt/samplers/pmj02_sequence.h"
#include "pbrt/samplers/randomization.h"
#include "pbrt/samplers/sampler.h"

namespace pbrt {

/// Progressive multi-jittered (0,2) points. Positions of all samples in a square of pixels are one blue-noise point
/// set. For other dimensions a pixel uses one of a few fixed sets, in a random order that keeps runs of 4, 16, ...
/// samples together. Digits are flipped by masks with blue noise over the image, which preserves the (0,2) property.
class Pmj02bnSampler final : public Sampler {
  public:
    Pmj02bnSampler(int samplesPerPixel, int seed);
    int SamplesPerPixel() const override { return samplesPerPixel_; }
    Point2 GetPixel2D() override;
    std::unique_ptr<Sampler> Clone() const override { return std::make_unique<Pmj02bnSampler>(*this); }
    std::unique_ptr<Sampler> WithSeed(int seed) const override {
        return std::make_unique<Pmj02bnSampler>(samplesPerPixel_, seed);
    }

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
    int samplesPerPixel_;
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
