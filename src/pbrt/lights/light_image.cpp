#include "pbrt/lights/light_image.h"

#include <mutex>
#include <ranges>
#include <unordered_map>

#include "pbrt/core/parallel.h"
#include "pbrt/math/rng.h"

namespace pbrt {
namespace {

LightImage Read(const std::string &path, auto select) {
    ImageFile file = ReadImage(path);
    LightImage result{select(file.image), file.metadata.colorSpace ? file.metadata.colorSpace : &ColorSpace::SRGB(),
                      path};
    ForEachValue(result.image, [&](Point2i p, int c) {
        if (!std::isfinite(result.image.Get(p, c)))
            throw UserError("\"{}\": pixel ({}, {}) is infinite or not a number; such an image cannot emit light.",
                            path, p.x, p.y);
    });
    return result;
}

}  // namespace

LightImage ReadLightImage(const std::string &path) {
    return Read(path, [&](const Image &image) {
        if (!image.HasRgb()) throw UserError("\"{}\": an image that emits light must have channels R, G and B.", path);
        return image.Select({"R", "G", "B"});
    });
}

LightImage ReadIntensityImage(const std::string &path) {
    return Read(path, [&](const Image &image) {
        bool hasY = image.FindChannel("Y") >= 0;
        if (image.HasRgb() == hasY)
            throw UserError("\"{}\": an image of intensities must have either a channel Y or channels R, G and B.",
                            path);
        if (hasY) return image.Select({"Y"});
        Image rgb = image.Select({"R", "G", "B"}), mean(PixelFormat::Float, rgb.Resolution(), {"Y"});
        ForEachPixel(rgb, [&](Point2i p) { mean.Set(p, 0, (rgb.Get(p, 0) + rgb.Get(p, 1) + rgb.Get(p, 2)) / 3); });
        return mean;
    });
}

std::shared_ptr<const DenseSpectrum> InternSpectrum(const Spectrum &s) {
    static std::mutex mutex;
    static std::unordered_map<uint64_t, std::weak_ptr<const DenseSpectrum>> known;

    auto dense = std::make_shared<const DenseSpectrum>(s);
    uint64_t hash = 0;
    const auto nanometres = std::views::iota(int(LambdaMin), int(LambdaMax) + 1);
    for (const int nm : nanometres) hash = Hash(hash, (*dense)(Float(nm)));

    std::lock_guard lock(mutex);
    std::weak_ptr<const DenseSpectrum> &slot = known[hash];
    if (std::shared_ptr<const DenseSpectrum> old = slot.lock()) {
        const auto isEqualAt = [&](int nm) { return (*old)(Float(nm)) == (*dense)(Float(nm)); };
        return std::ranges::all_of(nanometres, isEqualAt) ? old : dense;
    }
    slot = dense;
    return dense;
}

SampledSpectrum AverageIlluminant(const Image &image, const ColorSpace &colorSpace, const SampledWavelengths &lambda,
                                  const std::function<Float(int, int)> &weight) {
    Point2i n = image.Resolution();
    std::vector<SampledSpectrum> rows(n.y);
    ParallelForEach(n.y, 8, [&](int64_t y) {
        SampledSpectrum sum;
        for (int x = 0; x < n.x; ++x) {
            SampledSpectrum L = PixelIlluminant(image, {x, int(y)}, colorSpace, lambda);
            sum += weight ? weight(x, int(y)) * L : L;
        }
        rows[y] = sum / Float(n.x);
    });
    SampledSpectrum sum;
    for (const SampledSpectrum &row : rows) sum += row;
    return sum / Float(n.y);
}

}  // namespace pbrt
