#pragma once
#include <algorithm>

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
    SpectralFilm(const SpectralParams &params, const ParamSet &set, const FilmRequest &request)
        : RgbFilm(fmt::format("spectral {} {}", params.buckets.low, params.buckets.high), params, set, request,
                  params.buckets.count * double(sizeof(Sums) + sizeof(float))),
          buckets_(params.buckets), sums_(FirstSumOf(Frame().PixelCount())) {
        if (!(buckets_.high - buckets_.low >= Float(0.002) * Float(buckets_.count)))
            throw set.Error("lambdamin", "each of the {} buckets from {} to {} nm must be 0.002 nm wide at least.",
                            buckets_.count, buckets_.low, buckets_.high);
    }

    SampledWavelengths SampleWavelengths(Float u) const override {
        return SampledWavelengths::SampleUniform(u, buckets_.low, buckets_.high);
    }
    void AddSample(const FilmSample &sample) override {
        if (!AddColor(sample)) return;
        const Float scale = ScaleOf(sample.L);
        Sums *sums = sums_.data() + FirstSumOf(Frame().IndexOf(sample.pixel));
        const Float range = buckets_.high - buckets_.low;
        for (int i = 0; i < SpectrumSamples; ++i) {
            const Float pdf = sample.lambda.PdfAt(i);
            if (pdf == 0) continue;
            // A lone wavelength also represents the terminated ones: its density is smaller by their number. In single
            // precision, so that products are exact (PreciseSum).
            const auto w = double(sample.weight / (pdf * range));
            Sums &bucket = sums[BucketOf(sample.lambda[i])];
            bucket.radiance.Add(w * double(sample.L[i] * scale));
            bucket.weight.Add(w);
        }
    }
    void ExpectSplats() override {
        RgbFilm::ExpectSplats();
        bucketSplats_.Expect(sums_.size());
    }
    void AddSplat(Point2i pixel, const SampledSpectrum &L, const SampledWavelengths &lambda, Float weight) override {
        if (!PixelBounds().Contains(pixel)) return;
        const size_t index = Frame().IndexOf(pixel);
        // Each wavelength estimates the integral over a bucket; dividing by its width gives the mean.
        const double width = double(buckets_.high - buckets_.low) / buckets_.count;
        double parts[SpectrumSamples] = {};
        for (int i = 0; i < SpectrumSamples; ++i) {
            if (lambda.PdfAt(i) == 0) continue;
            parts[i] = double(weight) * double(L[i] * ScaleOf(L)) / (SpectrumSamples * double(lambda.PdfAt(i)) * width);
            if (!FixedSum::Holds(parts[i])) return Reject();
        }
        if (!AddSensorSplat(index, L, lambda, weight)) return;
        for (int i = 0; i < SpectrumSamples; ++i)
            if (parts[i] != 0) bucketSplats_.Add(FirstSumOf(index) + BucketOf(lambda[i]), parts[i]);
    }
    /// R, G, B, then S0.<centre>nm per bucket.
    Image ToImage() const override {
        std::vector<std::string> names;
        for (int b = 0; b < buckets_.count; ++b) {
            // The layout standard (Fichet et al. 2021) requires a comma in the number.
            std::string name = fmt::format("S0.{:.3f}nm", BucketCenter(b));
            name[name.find('.', 3)] = ',';
            names.push_back(name);
        }
        Image image = MakeImage(names);
        size_t i = 0;
        ForEachPixel(image, [&](Point2i p) {
            for (int b = 0; b < buckets_.count; ++b, ++i) {
                const double weight = sums_[i].weight.Value();
                double mean = weight != 0 ? sums_[i].radiance.Value() / weight : 0;
                if (bucketSplats_.AreExpected()) mean += bucketSplats_.Sum(i) * SplatScale();
                image.Set(p, 3 + b, Float(mean));
            }
        });
        return image;
    }
    ImageMetadata Metadata() const override {
        ImageMetadata metadata = Film::Metadata();
        metadata.attributes["spectralLayoutVersion"] = std::string("1.0");
        metadata.attributes["emissiveUnits"] = std::string("W.m^-2.sr^-1");
        return metadata;
    }

  private:
    struct Sums {
        PreciseSum radiance, weight;
        void operator+=(const Sums &s) {
            radiance += s.radiance;
            weight += s.weight;
        }
    };
    std::vector<StateBlock> Blocks() const override {
        std::vector<StateBlock> blocks = RgbFilm::Blocks();
        blocks.insert(blocks.begin(),
                      {MakeStateBlock("buckets", std::span(sums_)), bucketSplats_.Block("bucket splats")});
        return blocks;
    }
    /// In nm.
    Float BucketCenter(int bucket) const {
        return Lerp((Float(bucket) + Float(0.5)) / Float(buckets_.count), buckets_.low, buckets_.high);
    }
    int BucketOf(Float lambda) const {
        const Float position = (lambda - buckets_.low) / (buckets_.high - buckets_.low) * Float(buckets_.count);
        return std::clamp(int(position), 0, buckets_.count - 1);
    }
    /// Factor from L to output units, including scaling down to maxcomponentvalue.
    Float ScaleOf(const SampledSpectrum &L) const {
        // Emission is in photometric units (radiance over the integral of y-bar); this factor restores radiance.
        Float scale = CieYIntegral;
        if (Float max = L.MaxComponent(); max > MaxComponentValue()) scale *= MaxComponentValue() / max;
        return scale;
    }
    size_t FirstSumOf(size_t pixel) const { return pixel * buckets_.count; }

    SpectralBuckets buckets_;
    std::vector<Sums> sums_;
    Splats bucketSplats_;
};

}  // namespace pbrt
