#pragma once
#include <optional>

#include "pbrt/bxdfs/bxdf.h"
#include "pbrt/bxdfs/microfacet.h"

namespace pbrt {

/// Dielectric boundary, smooth or rough (Walter et al. 2007). `eta`: index below (z < 0) over index above. Sample
/// chooses reflection or transmission, if both are requested, in proportion to their fractions of the light.
class DielectricBxdf {
  public:
    DielectricBxdf(Float eta, const TrowbridgeReitz &facets) : eta_(eta), facets_(facets) {}

    BxdfFlags Flags() const {
        BxdfFlags sides = eta_ == 1 ? BxdfFlags::Transmission : BxdfFlags::Reflection | BxdfFlags::Transmission;
        return sides | (IsSmooth() ? BxdfFlags::Specular : BxdfFlags::Glossy);
    }
    SampledSpectrum F(const Vector3 &wo, const Vector3 &wi, TransportMode mode) const;
    std::optional<BsdfSample> Sample(const Vector3 &wo, Float uc, const Point2 &u, TransportMode mode,
                                     ReflTransFlags which = ReflTransFlags::All) const;
    Float Pdf(const Vector3 &wo, const Vector3 &wi, TransportMode mode,
              ReflTransFlags which = ReflTransFlags::All) const;
    void Regularize() { facets_.Regularize(); }

    // For random walks. With visible-normal sampling, f |cos| / pdf is the Fresnel term times G / G1: the normal
    // distribution cancels.

    struct Drawn {
        Vector3 wi{};
        Float weight = 0;  ///< f |cos| / pdf; 0: sampling failed
        Float pdf = 0;     ///< as BsdfSample::pdf; only set by DrawTransmission
        bool isTransmitted = false;
    };
    Drawn DrawReflection(const Vector3 &wo, const Point2 &u) const;
    Drawn DrawTransmission(const Vector3 &wo, const Point2 &u, TransportMode mode) const;
    Drawn DrawEither(const Vector3 &wo, Float uc, const Point2 &u, TransportMode mode) const;
    /// F for directions on different sides of a rough boundary, and Pdf if only transmission is sampled.
    struct Transmission {
        Float f = 0, pdf = 0;
    };
    Transmission EvaluateTransmission(const Vector3 &wo, const Vector3 &wi, TransportMode mode) const;

    /// True if F is 0 everywhere: a specular boundary, or none (eta = 1).
    bool IsSmooth() const { return eta_ == 1 || facets_.EffectivelySmooth(); }
    Float Eta() const { return eta_; }
    const TrowbridgeReitz &Facets() const { return facets_; }

  private:
    struct Facet {
        Vector3 wm;             ///< on wo's side
        Float cosine, eta;      ///< of wo and wm, >= 0; index on the far side over that on wo's side
        Float fresnel, cosT{};  ///< reflectance; cosine of the refracted direction, if the reflectance is below 1
        Vector3 Refracted(const Vector3 &wo) const { return wm * (cosine / eta - cosT) - wo / eta; }
    };
    Facet DrawFacet(const Vector3 &wo, const Point2 &u) const;

    std::optional<BsdfSample> SampleSmooth(const Vector3 &wo, Float uc, TransportMode mode, ReflTransFlags which) const;
    /// Half vector (upper hemisphere) that scatters wo to wi, and the relative index across (1 for reflection). False
    /// if there is none.
    bool FacetBetween(const Vector3 &wo, const Vector3 &wi, bool reflect, Vector3 *wm, Float *etaRelative) const;

    Float eta_;
    TrowbridgeReitz facets_;
};

/// Thin pane whose two refractions cancel: light passes straight or is mirrored; internal bounces are summed.
class ThinDielectricBxdf {
  public:
    explicit ThinDielectricBxdf(Float eta) : eta_(eta) {}

    BxdfFlags Flags() const { return BxdfFlags::Reflection | BxdfFlags::Transmission | BxdfFlags::Specular; }
    SampledSpectrum F(const Vector3 &, const Vector3 &, TransportMode) const { return SampledSpectrum(0); }
    std::optional<BsdfSample> Sample(const Vector3 &wo, Float uc, const Point2 &u, TransportMode mode) const;
    Float Pdf(const Vector3 &, const Vector3 &, TransportMode) const { return 0; }

  private:
    Float eta_;
};

/// Metal of complex index eta + i k relative to the outside, smooth or rough (Torrance and Sparrow 1967).
class ConductorBxdf {
  public:
    ConductorBxdf(const TrowbridgeReitz &facets, const SampledSpectrum &eta, const SampledSpectrum &k)
        : facets_(facets), eta_(eta), k_(k) {}

    BxdfFlags Flags() const {
        return BxdfFlags::Reflection | (facets_.EffectivelySmooth() ? BxdfFlags::Specular : BxdfFlags::Glossy);
    }
    SampledSpectrum F(const Vector3 &wo, const Vector3 &wi, TransportMode mode) const;
    std::optional<BsdfSample> Sample(const Vector3 &wo, Float uc, const Point2 &u, TransportMode mode) const;
    Float Pdf(const Vector3 &wo, const Vector3 &wi, TransportMode mode) const;
    /// F without Fresnel reflectance: the lobe's shape at a fraction of the cost.
    Float Approximate(const Vector3 &wo, const Vector3 &wi) const {
        if (!SameHemisphere(wo, wi) || facets_.EffectivelySmooth()) return 0;
        return facets_.D(Normalize(wo + wi)) * facets_.G(wo, wi) / (4 * wo.z * wi.z);
    }
    void Regularize() { facets_.Regularize(); }

  private:
    TrowbridgeReitz facets_;
    SampledSpectrum eta_, k_;
};

}  // namespace pbrt
