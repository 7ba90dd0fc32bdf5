#pragma once
#include "pbrt/bxdfs/diffuse.h"
#include "pbrt/bxdfs/fresnel.h"

namespace pbrt {

/// Exit lobe of subsurface scattering: diffuse times Fresnel transmittance, normalised to albedo 1. For radiance the
/// factor eta^2 undoes the scaling at the entering refraction.
class NormalizedFresnelBxdf {
  public:
    /// `scale`: SubsurfaceTable::ExitScale().
    NormalizedFresnelBxdf(Float eta, Float scale) : eta_(eta), scale_(scale) {}

    BxdfFlags Flags() const { return BxdfFlags::Diffuse | BxdfFlags::Reflection; }
    SampledSpectrum F(const Vector3 &wo, const Vector3 &wi, TransportMode mode) const {
        if (!SameHemisphere(wo, wi)) return SampledSpectrum(0);
        const Float f = scale_ * (1 - FresnelDielectric(AbsCosTheta(wi), eta_));
        return SampledSpectrum(mode == TransportMode::Radiance ? f * Sqr(eta_) : f);
    }
    std::optional<BsdfSample> Sample(const Vector3 &wo, Float uc, const Point2 &u, TransportMode mode,
                                     ReflTransFlags which) const {
        std::optional<BsdfSample> sample = DiffuseBxdf(SampledSpectrum(1)).Sample(wo, uc, u, mode, which);
        if (sample) sample->f = F(wo, sample->wi, mode);
        return sample;
    }
    Float Pdf(const Vector3 &wo, const Vector3 &wi, TransportMode mode, ReflTransFlags which) const {
        return DiffuseBxdf(SampledSpectrum(1)).Pdf(wo, wi, mode, which);
    }
    void Regularize() {}

  private:
    Float eta_, scale_;
};

}  // namespace pbrt
