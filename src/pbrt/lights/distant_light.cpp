#include "pbrt/lights/distant_light.h"

namespace pbrt {

DistantLight::DistantLight(const Vector3 &wi, std::shared_ptr<const DenseSpectrum> irradiance, Float scale)
    : Light(LightKind::DeltaDirection), wi_(wi), irradiance_(std::move(irradiance)), scale_(scale) {}

void DistantLight::Preprocess(const Point3 &, Float sceneRadius) { sceneRadius_ = sceneRadius; }

SampledSpectrum DistantLight::Phi(const SampledWavelengths &lambda) const {
    return scale_ * Pi * Sqr(sceneRadius_) * irradiance_->Sample(lambda);
}

std::optional<LightLiSample> DistantLight::SampleLi(const LightSampleContext &from, const Point2 &,
                                                    const SampledWavelengths &lambda, bool) const {
    LightLiSample s;
    s.L = scale_ * irradiance_->Sample(lambda);
    if (!s.L) return {};
    s.wi = wi_;
    s.pdf = 1;
    s.pLight = from.p + wi_ * (2 * sceneRadius_);
    return s;
}

}  // namespace pbrt
