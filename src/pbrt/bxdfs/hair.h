#pragma once
#include <array>
#include <optional>

#include "pbrt/bxdfs/bxdf.h"
#include "pbrt/math/vec.h"

namespace pbrt {

/// Absorbing dielectric fibre with tilted scales (Marschner et al. 2003; near field, longitudinal and azimuthal lobes
/// as in Chiang et al. 2016). x runs along the fibre; light scatters over the whole sphere. Lobes: R, TT, TRT, and one
/// for all longer light paths.
class HairBxdf {
  public:
    /// `offset`: position of the hit across the fibre, -1 to 1. `sigmaA`: absorption per fibre radius. `betaM`,
    /// `betaN`: longitudinal and azimuthal roughness in (0, 1]. The scales are tilted by `alphaDegrees`.
    HairBxdf(Float offset, Float eta, const SampledSpectrum &sigmaA, Float betaM, Float betaN, Float alphaDegrees);

    BxdfFlags Flags() const { return BxdfFlags::Glossy | BxdfFlags::Reflection | BxdfFlags::Transmission; }
    /// The model is not reciprocal: for TransportMode::Importance, f(wi, wo).
    SampledSpectrum F(const Vector3 &wo, const Vector3 &wi, TransportMode mode) const;
    std::optional<BsdfSample> Sample(const Vector3 &wo, Float uc, const Point2 &u, TransportMode mode) const;
    Float Pdf(const Vector3 &wo, const Vector3 &wi, TransportMode) const;

    /// Absorption for which a mass of fibres of roughness `betaN` has reflectance `c` (Chiang et al. 2016).
    static SampledSpectrum AbsorptionOfReflectance(const SampledSpectrum &c, Float betaN);

    /// The last lobe holds all longer light paths and is uniform in azimuth.
    static constexpr int Lobes = 4;

  private:
    struct View {
        Float phi;                                       ///< azimuth of wo
        Float sinTheta[Lobes], cosTheta[Lobes];          ///< elevation, tilted by the scales, per lobe
        Float turn[Lobes - 1];                           ///< change of azimuth at the lobe's centre
        std::array<SampledSpectrum, Lobes> attenuation;  ///< per lobe; sums to 1 without absorption
    };
    View ViewFrom(const Vector3 &wo) const;
    /// Lobe densities at wi, by solid angle.
    std::array<Float, Lobes> Densities(const View &view, const Vector3 &wi) const;
    Float VarianceOf(int lobe) const { return lobe == 0 ? variance_ : lobe == 1 ? variance_ / 4 : variance_ * 4; }

    Float offset_, eta_, variance_, scale_, scaleMass_, sinAlpha_, cosAlpha_;
    SampledSpectrum sigmaA_;

  public:
    /// Terms of wo for Approximate.
    struct Terms {
        View view;
        std::array<Float, Lobes> averages;  ///< attenuations, averaged over the wavelengths
    };
    Terms ApproximationTerms(const Vector3 &wo) const;
    /// Wavelength-averaged F.
    Float Approximate(const Vector3 &wo, const Vector3 &wi, const Terms &terms) const;
};

/// Density, with respect to cos(theta) d theta, of the scattered elevation about the cone opposite to `o`; integrates
/// to 1 (d'Eon et al. 2011). Angles are given by sine and cosine. Exposed for tests.
Float LongitudinalDensity(Float sinI, Float cosI, Float sinO, Float cosO, Float variance);

/// Logistic density truncated to [-Pi, Pi] and normalised; `mass` is LogisticMass(scale). Exposed for tests.
Float LogisticMass(Float scale);
Float TrimmedLogistic(Float x, Float scale, Float mass);
Float SampleTrimmedLogistic(Float u, Float scale, Float mass);

}  // namespace pbrt
