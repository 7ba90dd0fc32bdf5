#pragma once
#include "pbrt/math/rng.h"
#include "pbrt/samplers/sampler.h"

namespace pbrt {

/// Random stream per pixel; each sample owns kDimensionsPerSample consecutive numbers.
class PixelStream {
  public:
    explicit PixelStream(int seed) : seed_(seed) {}
    void Start(Point2i pixel, int sampleIndex);
    FloatLanes Numbers(int dimension) const;

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
    int StartSample(Point2i pixel, int sampleIndex, int dimension) override;
    Run Prepare(int dimension, Numbers &numbers) override;

  private:
    int xSamples_, ySamples_;
    bool jitter_;
    PixelStream stream_;
    uint64_t pixelHash_ = 0;
    uint32_t index_ = 0;
};

}  // namespace pbrt
