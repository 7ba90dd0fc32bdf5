#include "pbrt/lights/point_light.h"

namespace pbrt {

PointLight::PointLight(const Point3 &position, std::shared_ptr<const DenseSpectrum> intensity, Float scale)
    : LightAtPoint(position), scale_(scale), intensity_(std::move(intensity)) {}

LightPower PointLight::Phi(const SampledWavelengths &lambda, uint32_t) const {
    return {4 * std::numbers::pi * double(scale_), intensity_->Sample(lambda)};
}

std::optional<LightBounds> PointLight::Bounds(uint32_t) const {
    return AllAround(4 * std::numbers::pi * double(scale_) * double(intensity_->MaxValue()));
}

}  // namespace pbrt
