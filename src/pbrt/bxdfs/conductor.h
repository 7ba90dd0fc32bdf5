#pragma once
#include <optional>

#include "pbrt/bxdfs/bxdf.h"
#include "pbrt/bxdfs/microfacet.h"

namespace pbrt {

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
