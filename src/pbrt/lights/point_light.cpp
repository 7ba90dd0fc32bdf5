#include "pbrt/lights/point_light.h"

#include "pbrt/lights/light_from_point.h"

namespace pbrt {

PointLight::PointLight(const Point3 &position, std::shared_ptr<const DenseSpectrum> intensity, Float scale)
    : Light(LightKind::DeltaPosition), position_(position), scale_(scale), intensity_(std::move(intensity)) {}

SampledSpectrum PointLight::Phi(const SampledWavelengths &lambda) const {
    return 4 * Pi * scale_ * intensity_->Sample(lambda);
}

std::optional<LightLiSample> PointLight::SampleLi(const LightSampleContext &from, const Point2 &,
                                                  const SampledWavelengths &lambda, bool) const {
    return SampleFromPoint(position_, from, [&](const Vector3 &) { return scale_ * intensity_->Sample(lambda); });
}

std::optional<LightBounds> PointLight::Bounds() const {
    Float phi = 4 * Pi * scale_ * intensity_->MaxValue();
    if (!(phi > 0)) return {};
    return LightBounds{Bounds3(position_), Vector3(0, 0, 1), phi, -1, 0, false};
}

}  // namespace pbrt
