#include "pbrt/samplers/random_samplers.h"

#include "pbrt/math/low_discrepancy.h"

namespace pbrt {

void PixelStream::Start(Point2i pixel, int sampleIndex) {
    uint64_t h = Hash(pixel, seed_);
    rng_.SetSequence(h, MixBits(h));
    rng_.Advance(static_cast<uint64_t>(sampleIndex) * kDimensionsPerSample);
}

FloatLanes PixelStream::Numbers(int dimension) const {
    Rng rng = rng_;
    rng.Advance(static_cast<uint64_t>(dimension));
    return rng.NextUniforms();
}

int StratifiedSampler::StartSample(Point2i pixel, int sampleIndex, int dimension) {
    int round = sampleIndex / SamplesPerPixel();
    index_ = static_cast<uint32_t>(sampleIndex - round * SamplesPerPixel());
    pixelHash_ = Hash(pixel, settings_.seed, round);
    if (jitter_) stream_.Start(pixel, sampleIndex);
    return dimension;
}

Sampler::Run StratifiedSampler::Prepare(int dimension, Numbers &numbers) {
    const FloatLanes offsets = jitter_ ? stream_.Numbers(dimension) : FloatLanes{} + Float(0.5);
    const auto strata = static_cast<uint32_t>(SamplesPerPixel());
    auto within = [](int stratum, Float offset, int count) {
        return std::min((static_cast<Float>(stratum) + offset) / static_cast<Float>(count), OneMinusEpsilon);
    };
    Lanes64 stratum[2];
    for (int half = 0; half < 2; ++half) {
        const uint64_t seed = pixelHash_ + static_cast<uint64_t>(dimension + half * Lanes64Count);
        stratum[half] = PermutationElement(index_, strata, CountingLanes(seed));
    }
    for (int i = 0; i < kPrepared - 1; ++i) {
        const auto s = static_cast<int>(stratum[i / Lanes64Count][i % Lanes64Count]);
        numbers.one[i] = within(s, offsets[i], SamplesPerPixel());
        numbers.two[i] = {within(s % xSamples_, offsets[i], xSamples_),
                          within(s / xSamples_, offsets[i + 1], ySamples_)};
    }
    return {dimension, kPrepared - 1};
}

}  // namespace pbrt
