#pragma once
#include "pbrt/math/low_discrepancy.h"
#include "pbrt/samplers/sampler.h"

namespace pbrt {

/// Random stream per pixel; each sample owns kDimensionsPerSample consecutive numbers.
class PixelStream {
  public:
    explicit PixelStream(int seed) : seed_(seed) {}
    void Start(Point2i pixel, int sampleIndex) {
        uint64_t h = Hash(pixel, seed_);
        rng_.SetSequence(h, MixBits(h));
        rng_.Advance(uint64_t(sampleIndex) * kDimensionsPerSample);
    }
    FloatLanes Numbers(int dimension) const {
        Rng rng = rng_;
        rng.Advance(uint64_t(dimension));
        return rng.NextUniforms();
    }

  private:
    static constexpr uint64_t kDimensionsPerSample = 65536;
    int seed_;
    Rng rng_;  ///< at the sample's first number
};

class IndependentSampler final : public SamplerBySettings<IndependentSampler> {
  public:
    explicit IndependentSampler(const SamplerSettings &settings)
        : SamplerBySettings(settings), stream_(settings.seed) {}

  protected:
    int StartSample(Point2i pixel, int sampleIndex, int dimension) override {
        stream_.Start(pixel, sampleIndex);
        return dimension;
    }
    Run Prepare(int dimension, Numbers &numbers) override {
        numbers.SetSequence(stream_.Numbers(dimension));
        return {dimension, kPrepared - 1};
    }

  private:
    PixelStream stream_;
};

/// Jittered stratification: each 2D request has one sample per xSamples * ySamples cell, in independent random order;
/// 1D requests likewise one per xSamples * ySamples interval.
class StratifiedSampler final : public Sampler {
  public:
    StratifiedSampler(int xSamples, int ySamples, bool jitter, int seed)
        : Sampler(SamplerSettings{.samplesPerPixel = xSamples * ySamples, .seed = seed}), xSamples_(xSamples),
          ySamples_(ySamples), jitter_(jitter), stream_(seed) {}
    std::unique_ptr<Sampler> Clone() const override { return std::make_unique<StratifiedSampler>(*this); }
    std::unique_ptr<Sampler> WithSeed(int seed) const override {
        return std::make_unique<StratifiedSampler>(xSamples_, ySamples_, jitter_, seed);
    }

  protected:
    int StartSample(Point2i pixel, int sampleIndex, int dimension) override {
        int round = sampleIndex / SamplesPerPixel();
        index_ = uint32_t(sampleIndex - round * SamplesPerPixel());
        pixelHash_ = Hash(pixel, settings_.seed, round);
        if (jitter_) stream_.Start(pixel, sampleIndex);
        return dimension;
    }
    Run Prepare(int dimension, Numbers &numbers) override {
        const FloatLanes offsets = jitter_ ? stream_.Numbers(dimension) : FloatLanes{} + Float(0.5);
        const auto strata = uint32_t(SamplesPerPixel());
        auto within = [](int stratum, Float offset, int count) {
            return std::min((Float(stratum) + offset) / Float(count), OneMinusEpsilon);
        };
        Lanes64 stratum[2];
        for (int half = 0; half < 2; ++half) {
            const uint64_t seed = pixelHash_ + uint64_t(dimension + half * Lanes64Count);
            stratum[half] = PermutationElementOf(index_, strata, CountingLanes(seed));
        }
        for (int i = 0; i < kPrepared - 1; ++i) {
            const auto s = int(stratum[i / Lanes64Count][i % Lanes64Count]);
            numbers.one[i] = within(s, offsets[i], SamplesPerPixel());
            numbers.two[i] = {within(s % xSamples_, offsets[i], xSamples_),
                              within(s / xSamples_, offsets[i + 1], ySamples_)};
        }
        return {dimension, kPrepared - 1};
    }

  private:
    int xSamples_, ySamples_;
    bool jitter_;
    PixelStream stream_;
    uint64_t pixelHash_ = 0;
    uint32_t index_ = 0;
};

}  // namespace pbrt
