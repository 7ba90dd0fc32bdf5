#pragma once
#include "pbrt/films/film.h"

namespace pbrt {

/// The `spectral` film: besides RGB the mean radiance within equal buckets of wavelength. Wavelengths are sampled
/// uniformly over the range of the buckets, so RGB knows nothing beyond it, as in stock pbrt-v4.
class SpectralFilm final : public RgbFilm {
  public:
    SpectralFilm(const ParamSet &params, const ColorSpace &outputSpace, Float exposureTime,
                 const FilmOverrides &overrides, DiagnosticSink &sink);

    int BucketCount() const { return bucketCount_; }
    Float BucketCenter(int bucket) const;  ///< nm

    SampledWavelengths SampleWavelengths(Float u) const { return SampledWavelengths::SampleUniform(u, low_, high_); }
    void AddSample(Point2i pixel, const SampledSpectrum &L, const SampledWavelengths &lambda, Float weight);

    /// R, G, B, then S0.<centre>nm per bucket.
    Image ToImage() const override;
    ImageMetadata Metadata() const override;

  private:
    struct Bucket {
        double sum = 0, weight = 0;
    };
    int bucketCount_;
    Float low_, high_;  ///< nm
    std::vector<Bucket> buckets_;
};

}  // namespace pbrt
