#include "pbrt/lights/spot_light.h"


namespace pbrt {

namespace {

/// 0 below a, 1 above b, cubic between.
Float SmoothStep(Float x, Float a, Float b) {
    if (a == b) return x < a ? Float(0) : Float(1);
    Float t = std::clamp((x - a) / (b - a), Float(0), Float(1));
    return t * t * (3 - 2 * t);
}

}  // namespace

SpotLight::SpotLight(const Transform &renderFromLight, const Point3 &from, const Vector3 &axis,
                     std::shared_ptr<const DenseSpectrum> intensity, Float scale, Float coneAngle, Float falloffStart)
    : LightAtPoint(renderFromLight.Point(from)),
      renderFromLight_(renderFromLight),
      axis_(axis),
      intensity_(std::move(intensity)),
      scale_(scale),
      coneAngle_(coneAngle),
      falloffStart_(falloffStart),
      cosEnd_(std::cos(Radians(coneAngle))),
      cosStart_(std::cos(Radians(falloffStart))) {}

Float SpotLight::PowerPerIntensity(Float coneAngle, Float falloffStart) {
    Float cosEnd = std::cos(Radians(coneAngle)), cosStart = std::cos(Radians(falloffStart));
    // The cubic averages to 1/2 over the falloff region.
    return 2 * Pi * ((1 - cosStart) + (cosStart - cosEnd) / 2);
}

Float SpotLight::Falloff(const Vector3 &w) const {
    return SmoothStep(Dot(Normalize(renderFromLight_.InverseVector(w)), axis_), cosEnd_, cosStart_);
}

SampledSpectrum SpotLight::Phi(const SampledWavelengths &lambda) const {
    return scale_ * PowerPerIntensity(coneAngle_, falloffStart_) * intensity_->Sample(lambda);
}

SampledSpectrum SpotLight::Intensity(const Vector3 &w, const SampledWavelengths &lambda) const {
    return scale_ * Falloff(w) * intensity_->Sample(lambda);
}

std::optional<LightBounds> SpotLight::Bounds() const {
    Float phi = 4 * Pi * scale_ * intensity_->MaxValue();
    if (!(phi > 0)) return {};
    LightBounds b{Bounds3(position_), Normalize(renderFromLight_.Vector(axis_)), phi, cosStart_, 0, false};
    if (!IsSimilarity(renderFromLight_)) {
        b.cosTheta_o = -1;
        return b;
    }
    b.cosTheta_e = std::cos(SafeACos(cosEnd_) - SafeACos(cosStart_));
    // A thin falloff region must not vanish in rounding.
    if (b.cosTheta_e == 1) b.cosTheta_e = Float(0.999);
    return b;
}

}  // namespace pbrt
