#pragma once
#include "pbrt/math/low_discrepancy.h"
#include "pbrt/samplers/sampler.h"

namespace pbrt {

/// Halton points over tiles of up to 128 x 128 pixels. Bases 2 and 3, scaled by the power that covers the tile, give
/// the film position, so each pixel owns every (2^j 3^k)-th point; other bases give the other dimensions.
class HaltonSampler final : public SamplerBySettings<HaltonSampler> {
  public:
    explicit HaltonSampler(const SamplerSettings &settings);
    Point2 GetPixel2D() override;

    uint64_t Index() const { return index_; }
    Point2i TileScale() const { return scale_; }

    /// With permuted digits the first dimensions, except the film's, use affine permutations: in a large base these
    /// keep a pixel's few samples spread over the interval, unlike random permutations. Between successive samples the
    /// first digit advances by Step(dimension), modulo the base. Only the shifts are random. Later dimensions use
    /// random permutations.
    static constexpr int StepCount = 64;
    static int Step(int dimension);

  protected:
    int StartSample(Point2i pixel, int sampleIndex, int dimension) override;
    Run Prepare(int dimension, Numbers &numbers) override;

  private:
    Float Dimension(int dimension) const;
    static constexpr int kTile = 128;
    uint64_t seed_;
    std::shared_ptr<const DigitPermutations> permutations_;
    Point2i scale_{1, 1};             ///< 2^j and 3^k
    Point2i exponents_{0, 0};         ///< j and k
    uint64_t stride_ = 1;             ///< product of the scales
    uint64_t xStep_ = 0, yStep_ = 0;  ///< 1 modulo one scale and 0 modulo the other
    Point2i pixel_{-1, -1};
    uint64_t pixelIndex_ = 0;  ///< of the pixel's first sample
    uint64_t index_ = 0;
};

}  // namespace pbrt
