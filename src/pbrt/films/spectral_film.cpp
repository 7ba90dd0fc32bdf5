#include "pbrt/films/spectral_film.h"

#include <algorithm>

namespace pbrt {

namespace {

int ReadBucketCount(const ParamSet &params) { return params.GetInt("nbuckets", 16, {1, 1 << 16}); }

}  // namespace

SpectralFilm::SpectralFilm(const ParamSet &params, const ColorSpace &outputSpace, Float exposureTime,
                           const FilmOverrides &overrides, DiagnosticSink &sink)
    : RgbFilm(FilmKind::Spectral, params, outputSpace, exposureTime, overrides, sink,
              ReadBucketCount(params) * static_cast<double>(sizeof(Bucket) + sizeof(float))) {
    bucketCount_ = ReadBucketCount(params);
    constexpr Range<Float> kVisible{LambdaMin, LambdaMax};  // nm
    low_ = params.GetFloat("lambdamin", LambdaMin, kVisible);
    high_ = params.GetFloat("lambdamax", LambdaMax, kVisible);
    if (!(low_ < high_))
        throw UserError(fmt::format("{}: \"lambdamin\" is {} nm, \"lambdamax\" {} nm; the range is empty.",
                                    params.What(), low_, high_),
                        params.LocOf("lambdamin"));
    buckets_.resize(PixelCount() * static_cast<size_t>(bucketCount_));
}

Float SpectralFilm::BucketCenter(int bucket) const {
    return Lerp((static_cast<Float>(bucket) + Float(0.5)) / static_cast<Float>(bucketCount_), low_, high_);
}

void SpectralFilm::AddSample(Point2i pixel, const SampledSpectrum &L, const SampledWavelengths &lambda, Float weight) {
    PBRT_DCHECK(PixelBounds().Contains(pixel));
    Vector3 sensor;
    if (!Measure(L, lambda, weight, &sensor)) return;
    const size_t index = IndexOf(pixel);
    AddToSums(index, sensor, weight);
    // Emission is in photometric units, where a radiance is divided by the integral of y-bar.
    Float scale = CieYIntegral;
    if (Float largest = L.MaxComponent(); largest > MaxComponentValue()) scale *= MaxComponentValue() / largest;
    Bucket *buckets = buckets_.data() + index * static_cast<size_t>(bucketCount_);
    const Float range = high_ - low_;
    for (int i = 0; i < SpectrumSamples; ++i) {
        if (lambda.PdfAt(i) == 0) continue;
        // A wavelength that goes on alone stands for those that ended: its density is that much smaller.
        const double w = double(weight) / double(lambda.PdfAt(i) * range);
        const Float position = (lambda[i] - low_) / range * static_cast<Float>(bucketCount_);
        Bucket &b = buckets[std::clamp(static_cast<int>(position), 0, bucketCount_ - 1)];
        b.sum += w * double(L[i] * scale);
        b.weight += w;
    }
}

Image SpectralFilm::ToImage() const {
    std::vector<std::string> names;
    for (int b = 0; b < bucketCount_; ++b) {
        // The layout standard (Fichet et al. 2021) wants a comma in the number.
        std::string name = fmt::format("S0.{:.3f}nm", BucketCenter(b));
        name[name.find('.', 3)] = ',';
        names.push_back(name);
    }
    Image image = MakeImage(names);
    const Bucket *bucket = buckets_.data();
    for (int y = 0; y < image.Resolution().y; ++y)
        for (int x = 0; x < image.Resolution().x; ++x)
            for (int b = 0; b < bucketCount_; ++b, ++bucket)
                image.Set({x, y}, 3 + b, bucket->weight != 0 ? static_cast<Float>(bucket->sum / bucket->weight) : 0);
    return image;
}

ImageMetadata SpectralFilm::Metadata() const {
    ImageMetadata metadata = RgbFilm::Metadata();
    metadata.attributes["spectralLayoutVersion"] = std::string("1.0");
    metadata.attributes["emissiveUnits"] = std::string("W.m^-2.sr^-1");
    return metadata;
}

}  // namespace pbrt
