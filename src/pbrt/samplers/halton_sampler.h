#pragma once
#include <array>
#include <cstring>

#include "pbrt/math/low_discrepancy.h"
#include "pbrt/samplers/sampler.h"

namespace pbrt {

/// Halton points over tiles of up to 128 x 128 pixels. Bases 2 and 3, scaled by the power that covers the tile, give
/// the film position, so each pixel owns every (2^j 3^k)-th point; other bases give the other dimensions.
class HaltonSampler final : public SamplerBySettings<HaltonSampler> {
  public:
    explicit HaltonSampler(const SamplerSettings &settings) : SamplerBySettings(settings), seed_(Hash(settings.seed)) {
        for (int axis = 0; axis < 2; ++axis) {
            int base = axis == 0 ? 2 : 3;
            while (scale_[axis] < std::min(settings.resolution[axis], kTile)) {
                scale_[axis] *= base;
                ++exponents_[axis];
            }
        }
        auto sx = uint64_t(scale_.x), sy = uint64_t(scale_.y);
        stride_ = sx * sy;
        xStep_ = sy * InverseModulo(sy, sx);
        yStep_ = sx * InverseModulo(sx, sy);
        if (settings.randomization == Randomization::PermuteDigits) {
            // Dimensions 0 and 1 are unused. No other base divides the stride.
            std::array<uint32_t, kSteps.size()> multipliers{1, 1};
            for (size_t d = 2; d < kSteps.size(); ++d) {
                const uint64_t base = Primes[d];
                multipliers[d] = uint32_t(kSteps[d] * InverseModulo(stride_ % base, base) % base);
            }
            permutations_ = std::make_shared<const DigitPermutations>(multipliers, seed_);
        }
    }
    Point2 GetPixel2D() override {
        return {RadicalInverse(2, index_ / uint64_t(scale_.x)), RadicalInverse(3, index_ / uint64_t(scale_.y))};
    }

    uint64_t Index() const { return index_; }
    Point2i TileScale() const { return scale_; }

    /// With permuted digits the first dimensions, except the film's, use affine permutations: in a large base these
    /// keep a pixel's few samples spread over the interval, unlike random permutations. Between successive samples the
    /// first digit advances by Step(dimension), modulo the base. Only the shifts are random. Later dimensions use
    /// random permutations.
    static constexpr int StepCount = 64;
    static int Step(int dimension) { return kSteps[dimension]; }

  protected:
    int StartSample(Point2i pixel, int sampleIndex, int dimension) override {
        // The first j mirrored binary digits of the index are the column in the tile; the first k ternary ones the row.
        // The Chinese remainder theorem combines both.
        if (pixel != pixel_) {
            pixel_ = pixel;
            auto x = uint64_t(Wrap(pixel.x, kTile)), y = uint64_t(Wrap(pixel.y, kTile));
            pixelIndex_ = (InverseRadicalInverse(x, 2, exponents_.x) * xStep_ +
                           InverseRadicalInverse(y, 3, exponents_.y) * yStep_) %
                          stride_;
        }
        index_ = pixelIndex_ + (settings_.firstSample + uint64_t(sampleIndex)) * stride_;
        return std::max(2, dimension);
    }
    Run Prepare(int dimension, Numbers &numbers) override {
        FloatLanes values{};
        int d = dimension;
        if (settings_.randomization == Randomization::PermuteDigits && dimension < StepCount) {
            alignas(64) Float known[kPrepared] = {};
            for (int first = dimension; first < std::min(StepCount, dimension + kPrepared); first += Lanes64Count)
                permutations_->RadicalInverses(first, index_, known + (first - dimension));
            std::memcpy(&values, known, sizeof(values));
            d = std::min(StepCount, dimension + kPrepared);
        }
        for (; d < dimension + kPrepared; ++d) values[d - dimension] = Dimension(d);
        numbers.SetSequence(values);
        return {dimension, kPrepared - 1};
    }

  private:
    static constexpr int kTile = 128;
    /// First-digit steps per dimension between samples of a pixel, see Step.
    static constexpr std::array<uint16_t, StepCount> kSteps = {
        1,  1,  2,  3,  3,  3,  3,  6,   3,  6,  13,  10, 16, 10, 15,  5,  28, 26,  18, 28, 17, 28,
        9,  43, 42, 15, 32, 25, 39, 11,  61, 35, 20,  55, 34, 52, 15,  77, 46, 28,  71, 41, 66, 19,
        93, 54, 34, 90, 52, 79, 23, 113, 66, 40, 104, 60, 93, 28, 131, 77, 43, 119, 70, 107};
    /// x < modulus with a * x = 1 (mod modulus); 0 if modulus is 1.
    static uint64_t InverseModulo(uint64_t a, uint64_t modulus) {
        for (uint64_t x = 1; x < modulus; ++x)
            if (a * x % modulus == 1) return x;
        return 0;
    }
    static int Wrap(int v, int n) { return (v % n + n) % n; }
    Float Dimension(int dimension) const {
        if (dimension >= PrimeCount) return HashFloat(index_, dimension, seed_);
        uint32_t base = Primes[dimension];
        switch (settings_.randomization) {
            case Randomization::None: return RadicalInverse(base, index_);
            case Randomization::PermuteDigits:
                return PermutedRadicalInverse(base, index_, DigitPermutations::SeedOf(seed_, dimension));
            default: return OwenScrambledRadicalInverse(base, index_, DigitPermutations::SeedOf(seed_, dimension));
        }
    }

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
