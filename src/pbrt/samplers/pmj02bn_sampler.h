#pragma once
#include <array>

#include "pbrt/samplers/blue_noise_mask.h"
#include "pbrt/samplers/pmj02_sequence.h"
#include "pbrt/samplers/randomization.h"
#include "pbrt/samplers/sampler.h"

namespace pbrt {

/// Progressive multi-jittered (0,2) points. The positions of all samples within a square of pixels are one point set
/// with blue noise. For all other dimensions a pixel takes the points of one of a few fixed sets, in its own random
/// order that keeps runs of 4, 16, ... samples together. Their digits are flipped by masks that have blue noise over
/// the image; after that they are still (0,2) points.
class Pmj02bnSampler final : public Sampler {
  public:
    Pmj02bnSampler(int samplesPerPixel, int seed);
    int SamplesPerPixel() const override { return samplesPerPixel_; }
    Point2 GetPixel2D() override;
    std::unique_ptr<Sampler> Clone() const override { return std::make_unique<Pmj02bnSampler>(*this); }
    std::unique_ptr<Sampler> WithSeed(int seed) const override {
        return std::make_unique<Pmj02bnSampler>(samplesPerPixel_, seed);
    }

    /// The sets: 2^SetLog2Count points each; the first one is for positions. Made at the first call.
    static constexpr int SetCount = 6, SetLog2Count = 16;
    static const std::vector<BinaryPoint> &Set(int index);

  protected:
    int StartSample(Point2i pixel, int sampleIndex, int dimension) override;
    Run Prepare(int dimension, Numbers &numbers) override;

  private:
    /// For eight dimensions from the given one on: places in the sets, and masks of flipped bits.
    Lanes64 PlacesFor(int dimension) const;
    Lanes64 FlipsFor(int dimension) const;

    std::array<const BinaryPoint *, SetCount> sets_;
    const BlueNoiseMask *mask_;
    int samplesPerPixel_;
    int log2Samples_;  ///< log2 of the samples per pixel, rounded up
    uint64_t seed_;
    int log2Tile_;                                                 ///< pixels of a tile along each side
    int log2PerPixel_;                                             ///< points of a tile in each of its pixels
    std::shared_ptr<const std::vector<BinaryPoint>> pixelPoints_;  ///< of a tile, by pixel, as fractions of the pixel
    Point2i pixel_{};
    int index_ = 0;
    uint64_t pixelHash_ = 0, setHash_ = 0;
};

}  // namespace pbrt
