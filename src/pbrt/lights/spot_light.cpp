#include "pbrt/lights/spot_light.h"

#include "pbrt/math/frame.h"
#include "pbrt/math/transform.h"
#include "pbrt/math/warps.h"

namespace pbrt {

SpotLight::SpotLight(const Transform &renderFromLight, const Point3 &from, const Vector3 &axis,
                     std::shared_ptr<const DenseSpectrum> intensity, Float scale, Float coneAngle, Float falloffStart)
    : LightAtPoint(renderFromLight.Point(from)), renderFromLight_(renderFromLight), axis_(axis),
      intensity_(std::move(intensity)), scale_(scale), coneAngle_(coneAngle), falloffStart_(falloffStart),
      cosEnd_(std::cos(Radians(coneAngle))), cosStart_(std::cos(Radians(falloffStart))) {}

Float SpotLight::PowerPerIntensity(Float coneAngle, Float falloffStart) {
    Float cosEnd = std::cos(Radians(coneAngle)), cosStart = std::cos(Radians(falloffStart));
    // The cubic averages to 1/2 over the falloff region.
    return 2 * Pi * ((1 - cosStart) + (cosStart - cosEnd) / 2);
}

Float SpotLight::Falloff(const Vector3 &w) const {
    return FalloffAt(Dot(Normalize(renderFromLight_.InverseVector(w)), axis_));
}

Float SpotLight::FalloffAt(Float cosine) const {
    const Float width = cosStart_ - cosEnd_;
    if (width == 0) return cosine >= cosEnd_ ? Float(1) : Float(0);
    // The cubic p with p(0) = 0, p(1) = 1 and p'(0) = p'(1) = 0 is 3 h^2 - 2 h^3.
    const Float h = std::clamp((cosine - cosEnd_) / width, Float(0), Float(1));
    return (3 - 2 * h) * Sqr(h);
}

Vector3 SpotLight::SampleDirection(const Point2 &u) const {
    // Share of PowerPerIntensity inside the cone of full intensity.
    const Float inner = 1 - cosStart_, outer = (cosStart_ - cosEnd_) / 2;
    const Float cut = inner / (inner + outer);
    Float cosine;
    if (u.x < cut || !(outer > 0)) {
        cosine = Lerp(cut > 0 ? u.x / cut : u.x, Float(1), cosStart_);
    } else {
        // The cubic p of FalloffAt has the distribution function 2 h^3 - h^4, inverted by bisection.
        const Float share = (u.x - cut) / (1 - cut);
        Float low = 0, high = 1;
        for (int i = 0; i < 24; ++i) {
            const Float h = (low + high) / 2;
            (h * h * h * (2 - h) < share ? low : high) = h;
        }
        cosine = Lerp((low + high) / 2, cosEnd_, cosStart_);
    }
    const Vector3 aroundZ = SphericalDirectionOfTurn(SafeSqrt(1 - Sqr(cosine)), cosine, u.y);
    return Normalize(renderFromLight_.Vector(Frame::FromZ(axis_).FromLocal(aroundZ)));
}

Float SpotLight::PdfDirection(const Vector3 &w) const {
    const Float power = PowerPerIntensity(coneAngle_, falloffStart_);
    return power > 0 ? MappedDirectionPdf(renderFromLight_, w, Falloff(w) / power) : 0;
}

LightPower SpotLight::Phi(const SampledWavelengths &lambda, uint32_t) const {
    return {double(scale_) * double(PowerPerIntensity(coneAngle_, falloffStart_)), intensity_->Sample(lambda)};
}

SampledSpectrum SpotLight::Intensity(const Vector3 &w, const SampledWavelengths &lambda) const {
    return scale_ * Falloff(w) * intensity_->Sample(lambda);
}

std::optional<LightBounds> SpotLight::Bounds(uint32_t) const {
    const double phi = 4 * std::numbers::pi * double(scale_) * double(intensity_->MaxValue());
    if (!(phi > 0)) return {};
    LightBounds b{Bounds3(position_), Normalize(renderFromLight_.Vector(axis_)), phi, cosStart_, 0, false};
    if (!IsSimilarity(renderFromLight_)) {
        b.cosTheta_o = -1;
        return b;
    }
    b.cosTheta_e = std::cos(SafeACos(cosEnd_) - SafeACos(cosStart_));
    // Prevents rounding from removing a thin falloff region.
    if (b.cosTheta_e == 1) b.cosTheta_e = Float(0.999);
    return b;
}

}  // namespace pbrt
