#include "pbrt/lights/distant_light.h"

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

}  // namespace pbrt
