#include "pbrt/lights/point_light.h"

namespace pbrt {

PointLight::PointLight(const Point3 &position, std::shared_ptr<const DenseSpectrum> intensity, Float scale)
    : Light(LightKind::DeltaPosition), position_(position), scale_(scale), intensity_(std::move(intensity)) {}

SampledSpectrum PointLight::Phi(const SampledWavelengths &lambda) const {
    return 4 * Pi * scale_ * intensity_->Sample(lambda);
}

std::optional<LightLiSample> PointLight::SampleLi(const LightSampleContext &from, const Point2 &,
                                                  const SampledWavelengths &lambda, bool) const {
    Vector3 d = position_ - from.p;
    Float d2 = LengthSquared(d);
    if (!(d2 > 0)) return {};
    LightLiSample s;
    s.L = intensity_->Sample(lambda) * (scale_ / d2);
    if (!s.L) return {};
    s.wi = d / std::sqrt(d2);
    s.pdf = 1;
    s.pLight = position_;
    return s;
}

std::optional<LightBounds> PointLight::Bounds() const {
    Float phi = 4 * Pi * scale_ * intensity_->MaxValue();
    if (!(phi > 0)) return {};
    return LightBounds{Bounds3(position_), Vector3(0, 0, 1), phi, -1, 0, false};
}

}  // namespace pbrt
