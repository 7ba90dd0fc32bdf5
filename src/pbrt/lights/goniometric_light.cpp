#include "pbrt/lights/goniometric_light.h"

#include "pbrt/core/error.h"
#include "pbrt/lights/light_image.h"
#include "pbrt/math/transform.h"
#include "pbrt/math/warps.h"

namespace pbrt {

GoniometricLight::GoniometricLight(const Transform &renderFromLight, std::shared_ptr<const DenseSpectrum> intensity,
                                   Float scale, Image image)
    : LightAtPoint(renderFromLight.Point({0, 0, 0})), renderFromLight_(renderFromLight),
      intensity_(std::move(intensity)), scale_(scale), image_(std::move(image)), mean_(Mean(image_)) {
    PBRT_CHECK(image_.Resolution().x > 0 && image_.Resolution().x == image_.Resolution().y &&
               image_.ChannelCount() == 1);
}

Float GoniometricLight::Mean(const Image &image) {
    Point2i n = image.Resolution();
    double sum = 0;
    for (int y = 0; y < n.y; ++y)
        for (int x = 0; x < n.x; ++x) sum += double(std::max(image.Get({x, y}, 0), Float(0)));
    return Float(sum / (double(n.x) * double(n.y)));
}

Point2 GoniometricLight::SquareTowards(const Vector3 &w) const {
    Vector3 l = Normalize(renderFromLight_.InverseVector(w));
    return EqualAreaSphereToSquare({l.x, l.z, l.y});
}

Float GoniometricLight::Share(const Vector3 &w) const {
    return std::max(image_.Get(PixelAt(SquareTowards(w), image_.Resolution()), 0), Float(0));
}

const PiecewiseConstant2D &GoniometricLight::Distribution() const {
    std::call_once(distributionReady_, [&] {
        const Point2i n = image_.Resolution();
        std::vector<Float> weights;
        for (int y = 0; y < n.y; ++y)
            for (int x = 0; x < n.x; ++x) weights.push_back(std::max(image_.Get({x, y}, 0), Float(0)));
        distribution_ = PiecewiseConstant2D(weights, n.x, n.y);
    });
    return distribution_;
}

Vector3 GoniometricLight::SampleDirection(const Point2 &u) const {
    Float pdf;
    const Vector3 l = EqualAreaSquareToSphere(Distribution().Sample(u, &pdf));
    return Normalize(renderFromLight_.Vector({l.x, l.z, l.y}));
}

Float GoniometricLight::PdfDirection(const Vector3 &w) const {
    return MappedDirectionPdf(renderFromLight_, w, Distribution().Pdf(SquareTowards(w)) * Inv4Pi);
}

LightPower GoniometricLight::Phi(const SampledWavelengths &lambda, uint32_t) const {
    return {4 * std::numbers::pi * double(mean_) * double(scale_), intensity_->Sample(lambda)};
}

SampledSpectrum GoniometricLight::Intensity(const Vector3 &w, const SampledWavelengths &lambda) const {
    return scale_ * Share(w) * intensity_->Sample(lambda);
}

std::optional<LightBounds> GoniometricLight::Bounds(uint32_t) const {
    // As a point light of equal power (stock pbrt-v4).
    return AllAround(4 * std::numbers::pi * double(mean_) * double(scale_) * double(intensity_->MaxValue()));
}

}  // namespace pbrt
