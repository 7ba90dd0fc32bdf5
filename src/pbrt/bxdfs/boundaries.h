#pragma once
#include <optional>

#include "pbrt/bxdfs/bxdf.h"
#include "pbrt/math/frame.h"

namespace pbrt {

/// Anisotropic Trowbridge-Reitz (GGX) distribution with Smith's height-correlated shadowing (Heitz 2014). Local
/// coordinates; directions may be on either side.
class TrowbridgeReitz {
  public:
    TrowbridgeReitz() = default;
    TrowbridgeReitz(Float alphaX, Float alphaY) : alphaX_(alphaX), alphaY_(alphaY) {
        if (!EffectivelySmooth()) {
            alphaX_ = std::max(alphaX_, kMinAlpha);
            alphaY_ = std::max(alphaY_, kMinAlpha);
        }
    }

    /// Remaps the "roughness" of scene files to alpha. Textures may be negative, which counts as 0.
    static Float RoughnessToAlpha(Float roughness) { return SafeSqrt(roughness); }
    bool EffectivelySmooth() const { return std::max(alphaX_, alphaY_) < Float(1e-3); }
    Float AlphaX() const { return alphaX_; }
    Float AlphaY() const { return alphaY_; }

    /// Microfacet area density at normal wm; D(wm) |cos| integrates to 1 over the hemisphere.
    Float D(const Vector3 &wm) const {
        Float s = Sqr(wm.x / alphaX_) + Sqr(wm.y / alphaY_) + Sqr(wm.z);
        return 1 / (Pi * alphaX_ * alphaY_ * s * s);
    }
    /// Fraction of the microfacets facing w that are visible from w.
    Float G1(const Vector3 &w) const { return 2 / (1 + SlopeRoot(w)); }
    /// Fraction of microfacets visible from both directions.
    Float G(const Vector3 &wo, const Vector3 &wi) const { return 2 / (SlopeRoot(wo) + SlopeRoot(wi)); }

    /// G(wo, wi) / G1(wo): fraction of the facets visible from wo that are also visible from wi.
    Float GOverG1(const Vector3 &wo, const Vector3 &wi) const {
        const Float rootO = SlopeRoot(wo);
        return (1 + rootO) / (rootO + SlopeRoot(wi));
    }

    /// Density, by solid angle, of normal wm (upper hemisphere) among those visible from w.
    Float VisiblePdf(const Vector3 &w, const Vector3 &wm) const {
        return G1(w) / AbsCosTheta(w) * D(wm) * AbsDot(w, wm);
    }
    /// Samples VisiblePdf (Heitz 2018): stretched to the unit hemisphere, the visible part projects along w to a half
    /// disk plus half an ellipse.
    Vector3 SampleVisible(const Vector3 &w, const Point2 &u) const {
        Vector3 view = Normalize({alphaX_ * w.x, alphaY_ * w.y, w.z});
        if (view.z < 0) view = -view;
        Float length2 = Sqr(view.x) + Sqr(view.y);
        Vector3 t1 = length2 > Float(1e-12) ? Vector3(-view.y, view.x, 0) / std::sqrt(length2) : Vector3(1, 0, 0);
        Vector3 t2 = Cross(view, t1);

        Float r = std::sqrt(u.x), phi = 2 * Pi * u.y;
        Float p1 = r * std::cos(phi), p2 = r * std::sin(phi);
        p2 = Lerp((1 + view.z) / 2, SafeSqrt(1 - p1 * p1), p2);
        Float p3 = SafeSqrt(1 - p1 * p1 - p2 * p2);
        Vector3 n = t1 * p1 + t2 * p2 + view * p3;
        return Normalize({alphaX_ * n.x, alphaY_ * n.y, std::max(Float(1e-6), n.z)});
    }

    /// Samples VisiblePdf by another, faster map (Dupuy and Benyoub 2023): after the stretch, reflections at visible
    /// normals fill a spherical cap.
    Vector3 SampleVisibleByCap(const Vector3 &w, const Point2 &u) const {
        Vector3 view = Normalize({alphaX_ * w.x, alphaY_ * w.y, w.z});
        if (view.z < 0) view = -view;
        const Float z = (1 - u.y) * (1 + view.z) - view.z;
        const Float r = SafeSqrt(1 - z * z), phi = 2 * Pi * u.x;
        const Vector3 n(r * std::cos(phi) + view.x, r * std::sin(phi) + view.y, z + view.z);
        return Normalize({alphaX_ * n.x, alphaY_ * n.y, std::max(Float(1e-6), n.z)});
    }

    /// Raises small alphas (pbrt-v4-format §5.5).
    void Regularize() {
        for (Float *alpha : {&alphaX_, &alphaY_})
            if (*alpha < Float(0.3)) *alpha = std::clamp(2 * *alpha, Float(0.1), Float(0.3));
    }

  private:
    /// Smith's 1 + 2 Lambda.
    Float SlopeRoot(const Vector3 &w) const {
        return std::sqrt(1 + (Sqr(alphaX_ * w.x) + Sqr(alphaY_ * w.y)) / Sqr(w.z));
    }

    static constexpr Float kMinAlpha = Float(1e-4);
    Float alphaX_ = 0, alphaY_ = 0;
};

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
