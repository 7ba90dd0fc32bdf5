#pragma once
#include <optional>

#include "pbrt/bxdfs/bxdf.h"
#include "pbrt/bxdfs/fresnel.h"
#include "pbrt/math/frame.h"
#include "pbrt/math/warps.h"

namespace pbrt {

// Lobes use local coordinates with z along the shading normal. Directions point away from the surface; densities are by
// solid angle.

/// Lambertian reflection on the side of wo.
class DiffuseBxdf {
  public:
    explicit DiffuseBxdf(const SampledSpectrum &reflectance) : reflectance_(reflectance) {}

    BxdfFlags Flags() const { return reflectance_ ? BxdfFlags::Diffuse | BxdfFlags::Reflection : BxdfFlags::None; }
    SampledSpectrum F(const Vector3 &wo, const Vector3 &wi, TransportMode) const {
        return SameHemisphere(wo, wi) ? reflectance_ * InvPi : SampledSpectrum(0);
    }
    std::optional<BsdfSample> Sample(const Vector3 &wo, Float, const Point2 &u, TransportMode) const {
        Vector3 wi = SampleCosineHemisphere(u);
        Float pdf = CosineHemispherePdf(wi.z);
        if (wo.z < 0) wi.z = -wi.z;
        return BsdfSample{reflectance_ * InvPi, wi, pdf, BxdfFlags::Diffuse | BxdfFlags::Reflection};
    }
    Float Pdf(const Vector3 &wo, const Vector3 &wi, TransportMode) const {
        return SameHemisphere(wo, wi) ? CosineHemispherePdf(AbsCosTheta(wi)) : 0;
    }
    Float Approximate(const Vector3 &wo, const Vector3 &wi) const {
        return SameHemisphere(wo, wi) ? reflectance_.Average() * InvPi : 0;
    }
    const SampledSpectrum &Reflectance() const { return reflectance_; }

  private:
    SampledSpectrum reflectance_;
};

/// Lambertian on both sides, chosen in proportion to the spectra's maxima.
class DiffuseTransmissionBxdf {
  public:
    DiffuseTransmissionBxdf(const SampledSpectrum &reflectance, const SampledSpectrum &transmittance)
        : reflectance_(reflectance), transmittance_(transmittance) {}

    BxdfFlags Flags() const {
        return (reflectance_ ? BxdfFlags::Diffuse | BxdfFlags::Reflection : BxdfFlags::None) |
               (transmittance_ ? BxdfFlags::Diffuse | BxdfFlags::Transmission : BxdfFlags::None);
    }
    SampledSpectrum F(const Vector3 &wo, const Vector3 &wi, TransportMode) const {
        return (SameHemisphere(wo, wi) ? reflectance_ : transmittance_) * InvPi;
    }
    std::optional<BsdfSample> Sample(const Vector3 &wo, Float uc, const Point2 &u, TransportMode) const {
        Float pr = reflectance_.MaxComponent(), pt = transmittance_.MaxComponent();
        if (pr + pt == 0) return {};
        Float reflection = pr / (pr + pt);
        Vector3 wi = SampleCosineHemisphere(u);
        Float pdf = CosineHemispherePdf(wi.z);
        bool reflect = uc < reflection;
        if ((wo.z < 0) == reflect) wi.z = -wi.z;
        if (reflect)
            return BsdfSample{reflectance_ * InvPi, wi, pdf * reflection, BxdfFlags::Diffuse | BxdfFlags::Reflection};
        return BsdfSample{transmittance_ * InvPi, wi, pdf * (pt / (pr + pt)),
                          BxdfFlags::Diffuse | BxdfFlags::Transmission};
    }
    Float Pdf(const Vector3 &wo, const Vector3 &wi, TransportMode) const {
        Float pr = reflectance_.MaxComponent(), pt = transmittance_.MaxComponent();
        if (pr + pt == 0) return 0;
        return (SameHemisphere(wo, wi) ? pr : pt) / (pr + pt) * CosineHemispherePdf(AbsCosTheta(wi));
    }

  private:
    SampledSpectrum reflectance_, transmittance_;
};

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
    std::optional<BsdfSample> Sample(const Vector3 &wo, Float uc, const Point2 &u, TransportMode mode) const {
        std::optional<BsdfSample> sample = DiffuseBxdf(SampledSpectrum(1)).Sample(wo, uc, u, mode);
        if (sample) sample->f = F(wo, sample->wi, mode);
        return sample;
    }
    Float Pdf(const Vector3 &wo, const Vector3 &wi, TransportMode mode) const {
        return DiffuseBxdf(SampledSpectrum(1)).Pdf(wo, wi, mode);
    }

  private:
    Float eta_, scale_;
};

}  // namespace pbrt
