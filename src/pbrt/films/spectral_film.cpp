#include "pbrt/films/spectral_film.h"

#include <algorithm>

namespace pbrt {
namespace {

const SpectralBuckets &Checked(const SpectralBuckets &b, const ParamSet &set) {
    if (!(b.low < b.high))
        throw set.Error("lambdamin", "\"lambdamin\" is {} nm, \"lambdamax\" {} nm; the range is empty.", b.low, b.high);
    return b;
}

}  // namespace

SpectralFilm::SpectralFilm(const SpectralParams &params, const ParamSet &set, const FilmRequest &request)
    : RgbFilm(fmt::format("spectral {} {}", params.buckets.low, params.buckets.high), params, set, request,
              params.buckets.count * double(sizeof(Sums) + sizeof(float))),
      buckets_(Checked(params.buckets, set)), sums_(FirstSumOf(Frame().PixelCount())) {}

Float SpectralFilm::BucketCenter(int bucket) const {
    return Lerp((Float(bucket) + Float(0.5)) / Float(buckets_.count), buckets_.low, buckets_.high);
}

int SpectralFilm::BucketOf(Float lambda) const {
    const Float position = (lambda - buckets_.low) / (buckets_.high - buckets_.low) * Float(buckets_.count);
    return std::clamp(int(position), 0, buckets_.count - 1);
}

Float SpectralFilm::ScaleOf(const SampledSpectrum &L) const {
    // Emission is in photometric units (radiance over the integral of y-bar); this factor restores radiance.
    Float scale = CieYIntegral;
    if (Float max = L.MaxComponent(); max > MaxComponentValue()) scale *= MaxComponentValue() / max;
    return scale;
}

void SpectralFilm::AddSample(const FilmSample &sample) {
    const std::optional<Vector3> sensor = Measure(sample.L, sample.lambda, sample.weight);
    if (!sensor) return;
    const size_t index = Frame().IndexOf(sample.pixel);
    Add(index, *sensor, sample.weight);
    const Float scale = ScaleOf(sample.L);
    Sums *sums = sums_.data() + FirstSumOf(index);
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

void SpectralFilm::ExpectSplats() {
    RgbFilm::ExpectSplats();
    bucketSplats_.Expect(sums_.size());
}

void SpectralFilm::AddSplat(Point2i pixel, const SampledSpectrum &L, const SampledWavelengths &lambda, Float weight) {
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

std::vector<StateBlock> SpectralFilm::Blocks() const {
    std::vector<StateBlock> blocks = RgbFilm::Blocks();
    blocks.insert(blocks.begin(), {MakeStateBlock("buckets", std::span(sums_)), bucketSplats_.Block("bucket splats")});
    return blocks;
}

Image SpectralFilm::ToImage() const {
    std::vector<std::string> names;
    for (int b = 0; b < buckets_.count; ++b) {
        // The layout standard (Fichet et al. 2021) requires a comma in the number.
        std::string name = fmt::format("S0.{:.3f}nm", BucketCenter(b));
        name[name.find('.', 3)] = ',';
        names.push_back(name);
    }
    Image image = MakeImage(names);
    size_t i = 0;
    for (int y = 0; y < image.Resolution().y; ++y)
        for (int x = 0; x < image.Resolution().x; ++x)
            for (int b = 0; b < buckets_.count; ++b, ++i) {
                const double weight = sums_[i].weight.Value();
                double mean = weight != 0 ? sums_[i].radiance.Value() / weight : 0;
                if (bucketSplats_.AreExpected()) mean += bucketSplats_.Sum(i) * SplatScale();
                image.Set({x, y}, 3 + b, Float(mean));
            }
    return image;
}

ImageMetadata SpectralFilm::Metadata() const {
    ImageMetadata metadata = Film::Metadata();
    metadata.attributes["spectralLayoutVersion"] = std::string("1.0");
    metadata.attributes["emissiveUnits"] = std::string("W.m^-2.sr^-1");
    return metadata;
}

}  // namespace pbrt
