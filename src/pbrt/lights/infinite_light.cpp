#include "pbrt/lights/infinite_light.h"

#include "pbrt/core/error.h"
#include "pbrt/lights/light_image.h"
#include "pbrt/math/warps.h"

namespace pbrt {

DistantLight::DistantLight(const Vector3 &wi, std::shared_ptr<const DenseSpectrum> irradiance, Float scale)
    : LightBeyondScene(LightKind::DeltaDirection), wi_(wi), irradiance_(std::move(irradiance)), scale_(scale) {}

LightPower DistantLight::Phi(const SampledWavelengths &lambda, uint32_t) const {
    return {double(scale_) * std::numbers::pi * Sqr(double(sceneRadius_)), irradiance_->Sample(lambda)};
}

std::optional<LightLiSample> DistantLight::SampleLi(const LightSampleContext &from, const Point2 &,
                                                    const SampledWavelengths &lambda, bool, uint32_t) const {
    LightLiSample s;
    s.L = scale_ * irradiance_->Sample(lambda);
    if (!s.L) return {};
    s.wi = wi_;
    s.pdf = 1;
    s.pLight = Beyond(from.p, wi_);
    return s;
}

namespace {

Float MeanOf(const Rgb &rgb) { return (rgb.x + rgb.y + rgb.z) / 3; }

}  // namespace

UniformInfiniteLight::UniformInfiniteLight(std::shared_ptr<const DenseSpectrum> radiance, Float scale)
    : radiance_(std::move(radiance)), scale_(scale) {}

LightPower UniformInfiniteLight::Phi(const SampledWavelengths &lambda, uint32_t) const {
    return {double(scale_) * Sqr(2 * std::numbers::pi * double(sceneRadius_)), radiance_->Sample(lambda)};
}

SampledSpectrum UniformInfiniteLight::Le(const Point3 &, const Vector3 &, const SampledWavelengths &lambda) const {
    return scale_ * radiance_->Sample(lambda);
}

std::optional<LightLiSample> UniformInfiniteLight::SampleDirection(const Point3 &, const Point2 &u,
                                                                   const SampledWavelengths &lambda,
                                                                   bool allowIncompletePdfs) const {
    if (allowIncompletePdfs) return {};
    LightLiSample s;
    s.L = scale_ * radiance_->Sample(lambda);
    if (!s.L) return {};
    s.wi = SampleUniformSphere(u);
    s.pdf = UniformSpherePdf();
    return s;
}

Float UniformInfiniteLight::DirectionPdf(const Point3 &, const Vector3 &, bool allowIncompletePdfs) const {
    return allowIncompletePdfs ? 0 : UniformSpherePdf();
}

ImageInfiniteLight::ImageInfiniteLight(const Transform &renderFromLight, Image image, const ColorSpace &colorSpace,
                                       Float scale)
    : renderFromLight_(renderFromLight), image_(std::move(image)), colorSpace_(&colorSpace), scale_(scale) {
    Point2i n = image_.Resolution();
    PBRT_CHECK(n.x == n.y && n.x > 0 && image_.ChannelCount() == 3);
    std::vector<Float> weights;
    weights.reserve(size_t(n.x) * size_t(n.y));
    double sum = 0;
    for (int y = 0; y < n.y; ++y)
        for (int x = 0; x < n.x; ++x) {
            weights.push_back(MeanOf(LightPixel(image_, {x, y})));
            sum += double(weights.back());
        }
    distribution_ = PiecewiseConstant2D(weights, n.x, n.y);

    auto average = Float(sum / double(weights.size()));
    bool anyLeft = false;
    for (Float &w : weights) {
        w = std::max(w - average, Float(0));
        anyLeft |= w > 0;
    }
    if (!anyLeft) std::fill(weights.begin(), weights.end(), Float(1));
    compensated_ = PiecewiseConstant2D(weights, n.x, n.y);
}

Float ImageInfiniteLight::MeanRadiance(const Vector3 &d) const {
    return MeanOf(LightPixel(image_, PixelAt(SquareTowards(d), image_.Resolution())));
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
    // Mean radiance over the sphere, times 4 pi sr, times the disk area of the scene's bounding sphere.
    return {double(scale_) * Sqr(2 * std::numbers::pi * double(sceneRadius_)),
            AverageIlluminant(image_, *colorSpace_, lambda)};
}

SampledSpectrum ImageInfiniteLight::Le(const Point3 &, const Vector3 &d, const SampledWavelengths &lambda) const {
    return Radiance(SquareTowards(d), lambda);
}

std::optional<LightLiSample> ImageInfiniteLight::SampleDirection(const Point3 &, const Point2 &u,
                                                                 const SampledWavelengths &lambda,
                                                                 bool allowIncompletePdfs) const {
    Float pdfSquare = 0;
    const Point2 st = (allowIncompletePdfs ? compensated_ : distribution_).Sample(u, &pdfSquare);
    if (!(pdfSquare > 0)) return {};
    LightLiSample s;
    s.L = Radiance(st, lambda);
    if (!s.L) return {};
    s.wi = DirectionAt(st);
    s.pdf = pdfSquare * Inv4Pi;
    return s;
}

Float ImageInfiniteLight::DirectionPdf(const Point3 &, const Vector3 &wi, bool allowIncompletePdfs) const {
    return (allowIncompletePdfs ? compensated_ : distribution_).Pdf(SquareTowards(wi)) * Inv4Pi;
}

}  // namespace pbrt
