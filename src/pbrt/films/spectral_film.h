#pragma once
#include "pbrt/films/rgb_film.h"

namespace pbrt {

struct SpectralBuckets {
    int count = 16;
    Float low = LambdaMin, high = LambdaMax;  ///< nm
};

struct SpectralParams : FilmParams {
    SpectralBuckets buckets;
    void Describe(auto &&v) {
        constexpr Range<Float> kVisible{LambdaMin, LambdaMax, false, false, "nm"};
        FilmParams::Describe(v);
        v("nbuckets", buckets.count, Range<int>{1, 1 << 16}, "number of spectral channels");
        v("lambdamin", buckets.low, kVisible, "start of the first bucket");
        v("lambdamax", buckets.high, kVisible, "end of the last bucket");
    }
};

/// The `spectral` film: RGB and the mean radiance in equal wavelength buckets. Wavelengths are sampled uniformly over
/// the buckets' range, so RGB excludes light beyond it, as in stock pbrt-v4.
class SpectralFilm final : public RgbFilm {
  public:
    SpectralFilm(const SpectralParams &params, const ParamSet &set, const FilmRequest &request);

    int BucketCount() const { return buckets_.count; }
    Float BucketCenter(int bucket) const;  ///< nm

    SampledWavelengths SampleWavelengths(Float u) const override {
        return SampledWavelengths::SampleUniform(u, buckets_.low, buckets_.high);
    }
    void AddSample(const FilmSample &sample) override;
    void ExpectSplats() override;
    void AddSplat(Point2i pixel, const SampledSpectrum &L, const SampledWavelengths &lambda, Float weight) override;
    /// R, G, B, then S0.<centre>nm per bucket.
    Image ToImage() const override;
    ImageMetadata Metadata() const override;

  private:
    struct Sums {
        PreciseSum radiance, weight;
        void operator+=(const Sums &s) {
            radiance += s.radiance;
            weight += s.weight;
        }
    };
    std::vector<StateBlock> Blocks() const override;
    int BucketOf(Float lambda) const;
    /// Factor from L to output units, including scaling down to maxcomponentvalue.
    Float ScaleOf(const SampledSpectrum &L) const;
    size_t FirstSumOf(size_t pixel) const { return pixel * buckets_.count; }

    SpectralBuckets buckets_;
    std::vector<Sums> sums_;
    Splats bucketSplats_;
};

}  // namespace pbrt
