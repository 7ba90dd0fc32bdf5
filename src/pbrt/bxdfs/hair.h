#pragma once
#include <array>
#include <optional>

#include "pbrt/bxdfs/bxdf.h"
#include "pbrt/math/vec.h"

namespace pbrt {

/// A fibre of dielectric with absorbing inside and tilted scales (Marschner et al. 2003; near field, longitudinal and
/// azimuthal lobes as in Chiang et al. 2016). x runs along the fibre; scatters over the whole sphere. By light paths:
/// mirrored outside (R), through (TT), once mirrored inside (TRT), and all the longer ones in one lobe.
class HairBxdf {
  public:
    /// `offset`: where the ray meets the fibre's width, -1 to 1. `sigmaA` by radius of the fibre; roughnesses along and
    /// around in (0, 1]; scales tilted by alpha degrees.
    HairBxdf(Float offset, Float eta, const SampledSpectrum &sigmaA, Float betaM, Float betaN, Float alphaDegrees);

    BxdfFlags Flags() const { return BxdfFlags::Glossy | BxdfFlags::Reflection | BxdfFlags::Transmission; }
    SampledSpectrum F(const Vector3 &wo, const Vector3 &wi, TransportMode) const;
    /// With only one of the sides asked for, samples of the other are rejected: Pdf then integrates to less than 1.
    std::optional<BsdfSample> Sample(const Vector3 &wo, Float uc, const Point2 &u, TransportMode,
                                     ReflTransFlags which) const;
    Float Pdf(const Vector3 &wo, const Vector3 &wi, TransportMode, ReflTransFlags which) const;
    void Regularize() {}

    /// What `betaN` makes of the absorption whose fibres, many together, look like reflectance `c` (Chiang et al.
    /// 2016).
    static SampledSpectrum AbsorptionOfReflectance(const SampledSpectrum &c, Float betaN);

    /// Lobes in the sum; the last one has all that is left, evenly around the fibre.
    static constexpr int Lobes = 4;

  private:
    /// All that depends on one direction and the offset only.
    struct View {
        Float phi;                                 ///< around the fibre
        Float sinTheta[Lobes], cosTheta[Lobes];    ///< elevation, turned by the scales as each lobe needs
        Float turn[Lobes - 1];                     ///< change of azimuth of the middle of each lobe
        std::array<SampledSpectrum, Lobes> share;  ///< of the light, by lobe; add up to 1 without absorption
    };
    View ViewFrom(const Vector3 &wo) const;
    /// Densities of the lobes at wi, by solid angle.
    std::array<Float, Lobes> Densities(const View &view, const Vector3 &wi) const;
    Float VarianceOf(int lobe) const { return lobe == 0 ? variance_ : lobe == 1 ? variance_ / 4 : variance_ * 4; }

    Float offset_, eta_, variance_, scale_, scaleMass_, sinAlpha_, cosAlpha_;
    SampledSpectrum sigmaA_;

  public:
    /// The mean of F(wo, .) over wavelengths, for many directions: what depends on wo is done once.
    class Approximation {
      public:
        Approximation(const HairBxdf &hair, const Vector3 &wo);
        Float operator()(const Vector3 &wi) const;

      private:
        const HairBxdf &hair_;
        View view_;
        std::array<Float, Lobes> shares_;
    };
};

/// Density of the elevation angle's sine and cosine (by theta, with respect to cos(theta) d theta) of light scattered
/// about the cone opposite to `o`; integrates to 1 (d'Eon et al. 2011). Exposed for tests.
Float LongitudinalDensity(Float sinI, Float cosI, Float sinO, Float cosO, Float variance);

/// Logistic density over [-Pi, Pi], cut there and normalised; `mass` is LogisticMass(scale). Exposed for tests.
Float LogisticMass(Float scale);
Float TrimmedLogistic(Float x, Float scale, Float mass);
Float SampleTrimmedLogistic(Float u, Float scale, Float mass);

}  // namespace pbrt
