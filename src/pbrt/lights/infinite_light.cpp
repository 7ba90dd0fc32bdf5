#include "pbrt/lights/infinite_light.h"

#include "pbrt/core/error.h"
#include "pbrt/lights/light_image.h"
#include "pbrt/lights/sky_tile.h"
#include "pbrt/math/warps.h"

namespace pbrt {

UniformInfiniteLight::UniformInfiniteLight(std::shared_ptr<const DenseSpectrum> radiance, Float scale)
    : radiance_(std::move(radiance)), scale_(scale) {}

LightPower UniformInfiniteLight::Phi(const SampledWavelengths &lambda, uint32_t) const {
    return {double(scale_) * Sqr(2 * std::numbers::pi * double(sceneRadius_)), radiance_->Sample(lambda)};
}

SampledSpectrum UniformInfiniteLight::Le(const Point3 &, const Vector3 &, const SampledWavelengths &lambda) const {
    return scale_ * radiance_->Sample(lambda);
}

std::optional<LightLiSample> UniformInfiniteLight::SampleSky(const Point2 &u, const SampledWavelengths &lambda,
                                                             bool allowIncompletePdfs, uint32_t part) const {
    if (allowIncompletePdfs && part == 0) return {};
    LightLiSample s;
    s.L = scale_ * radiance_->Sample(lambda);
    if (!s.L) return {};
    if (part == 0) {
        s.wi = SampleUniformSphere(u);
        s.pdf = UniformSpherePdf();
    } else {
        const SkyTile tile = SkyTile::Of(part);
        const Bounds2 square = tile.Square();
        s.wi = DirectionAt(square.low + u * (square.high - square.low));
        s.pdf = static_cast<Float>(1u << 2 * tile.level) * Inv4Pi;
    }
    return s;
}

Float UniformInfiniteLight::PdfOfSky(const Vector3 &wi, bool allowIncompletePdfs, uint32_t part) const {
    if (part == 0) return allowIncompletePdfs ? 0 : UniformSpherePdf();
    const uint32_t level = SkyTile::LevelOf(part);
    return SkyTile::At(level, SquareTowards(wi)).Number() == part ? static_cast<Float>(1u << 2 * level) * Inv4Pi : 0;
}

Point2 UniformInfiniteLight::SquareTowards(const Vector3 &d) const { return EqualAreaSphereToSquare(d); }
Vector3 UniformInfiniteLight::DirectionAt(const Point2 &st) const { return EqualAreaSquareToSphere(st); }

ImageInfiniteLight::ImageInfiniteLight(const Transform &renderFromLight, Image image, const ColorSpace &colorSpace,
                                       Float scale)
    : renderFromLight_(renderFromLight), image_(std::move(image)), colorSpace_(&colorSpace), scale_(scale) {
    Point2i n = image_.Resolution();
    PBRT_CHECK(n.x == n.y && n.x > 0 && image_.ChannelCount() == 3);
    std::vector<Float> weights = PixelMeans();
    double sum = 0;
    for (Float w : weights) sum += static_cast<double>(w);
    distribution_ = PiecewiseConstant2D(weights, n.x, n.y);

    auto average = static_cast<Float>(sum / static_cast<double>(weights.size()));
    bool anyLeft = false;
    for (Float &w : weights) {
        w = std::max(w - average, Float(0));
        anyLeft |= w > 0;
    }
    if (!anyLeft) std::fill(weights.begin(), weights.end(), Float(1));
    compensated_ = PiecewiseConstant2D(weights, n.x, n.y);
}

std::vector<Float> ImageInfiniteLight::PixelMeans() const {
    const Point2i n = image_.Resolution();
    std::vector<Float> means;
    means.reserve(static_cast<size_t>(n.x) * static_cast<size_t>(n.y));
    for (int y = 0; y < n.y; ++y)
        for (int x = 0; x < n.x; ++x) {
            Rgb rgb = LightPixel(image_, {x, y});
            means.push_back((rgb.x + rgb.y + rgb.z) / 3);
        }
    return means;
}

Float ImageInfiniteLight::MeanRadianceAt(const Point2 &st) const {
    const Rgb rgb = LightPixel(image_, PixelAt(st, image_.Resolution()));
    return (rgb.x + rgb.y + rgb.z) / 3;
}

void ImageInfiniteLight::PrepareTiles() const {
    std::call_once(tilesReady_, [&] {
        tiles_ = WindowedPiecewiseConstant2D(PixelMeans(), image_.Resolution().x, image_.Resolution().y);
    });
}

Point2 ImageInfiniteLight::SquareTowards(const Vector3 &d) const {
    return EqualAreaSphereToSquare(Normalize(renderFromLight_.InverseVector(d)));
}

Vector3 ImageInfiniteLight::DirectionAt(const Point2 &st) const {
    return Normalize(renderFromLight_.Vector(EqualAreaSquareToSphere(st)));
}

SampledSpectrum ImageInfiniteLight::Radiance(const Point2 &st, const SampledWavelengths &lambda) const {
    return scale_ * PixelIlluminant(image_, PixelAt(st, image_.Resolution()), *colorSpace_, lambda);
}

LightPower ImageInfiniteLight::Phi(const SampledWavelengths &lambda, uint32_t) const {
    // Radiance averaged over the sphere, times 4 pi sr, times the area of the disk of the scene's bounding sphere.
    return {double(scale_) * Sqr(2 * std::numbers::pi * double(sceneRadius_)),
            AverageIlluminant(image_, *colorSpace_, lambda)};
}

SampledSpectrum ImageInfiniteLight::Le(const Point3 &, const Vector3 &d, const SampledWavelengths &lambda) const {
    return Radiance(SquareTowards(d), lambda);
}

std::optional<LightLiSample> ImageInfiniteLight::SampleAt(const Point2 &st, Float pdfSquare,
                                                          const SampledWavelengths &lambda) const {
    if (!(pdfSquare > 0)) return {};
    LightLiSample s;
    s.L = Radiance(st, lambda);
    if (!s.L) return {};
    s.wi = DirectionAt(st);
    s.pdf = pdfSquare * Inv4Pi;
    return s;
}

std::optional<LightLiSample> ImageInfiniteLight::SampleSky(const Point2 &u, const SampledWavelengths &lambda,
                                                           bool allowIncompletePdfs, uint32_t part) const {
    Float pdfSquare = 0;
    if (part == 0) {
        const Point2 st = (allowIncompletePdfs ? compensated_ : distribution_).Sample(u, &pdfSquare);
        return SampleAt(st, pdfSquare, lambda);
    }
    const std::optional<Point2> st = tiles_.Sample(u, SkyTile::Of(part).Square(), &pdfSquare);
    return st ? SampleAt(*st, pdfSquare, lambda) : std::nullopt;
}

Float ImageInfiniteLight::PdfOfSky(const Vector3 &wi, bool allowIncompletePdfs, uint32_t part) const {
    const Point2 st = SquareTowards(wi);
    if (part == 0) return (allowIncompletePdfs ? compensated_ : distribution_).Pdf(st) * Inv4Pi;
    return tiles_.Pdf(st, SkyTile::Of(part).Square()) * Inv4Pi;
}

}  // namespace pbrt
