#pragma once
#include <optional>
#include <span>
#include <variant>

#include "pbrt/bxdfs/boundaries.h"
#include "pbrt/bxdfs/bxdf.h"
#include "pbrt/bxdfs/diffuse.h"
#include "pbrt/bxdfs/hair.h"
#include "pbrt/bxdfs/layered.h"
#include "pbrt/bxdfs/measured.h"
#include "pbrt/math/frame.h"

namespace pbrt {

/// Lobes by value (std::monostate: no scattering, rays pass) with their shading frame. Directions are in rendering
/// space and point away from the surface; densities are by solid angle. Lives on the stack.
class Bsdf {
  public:
    using Lobe = std::variant<std::monostate, DiffuseBxdf, DiffuseTransmissionBxdf, ConductorBxdf, DielectricBxdf,
                              ThinDielectricBxdf, CoatedDiffuseBxdf, CoatedConductorBxdf, HairBxdf, MeasuredBxdf,
                              NormalizedFresnelBxdf>;

    Bsdf() = default;
    Bsdf(const Normal3 &ns, const Vector3 &dpdus, const auto &lobe)
        : frame_(Frame::FromXZ(dpdus, ns)), lobe_(lobe), flags_(lobe.Flags()) {}

    explicit operator bool() const { return !std::holds_alternative<std::monostate>(lobe_); }
    BxdfFlags Flags() const { return flags_; }
    /// True if F has a glossy lobe, alone or as part of a coat, so that sampling should include F.
    bool IsDirectional() const;
    /// False if F is a stochastic estimate (layers without a table), whose mean depends on the sampling of directions.
    bool HasExactF() const;
    /// Writes to f[k] an approximation of F(wo, wi[k]), averaged over wavelengths, up to a factor nearly independent of
    /// wi. Cheap and deterministic (no random walks in layers, no Fresnel term of metals): for importance, not for
    /// radiance.
    void ApproximateF(const Vector3 &wo, std::span<const Vector3> wi, Float *f) const;
    /// f(wo, wi); 0 for specular lobes.
    SampledSpectrum F(const Vector3 &wo, const Vector3 &wi, TransportMode mode = TransportMode::Radiance) const;
    /// Function sampled by Sample: F, except for rough coats, whose F has stock pbrt-v4's bias (CoatedBxdf). For
    /// directions that replace Sample's.
    SampledSpectrum FOfSamples(const Vector3 &wo, const Vector3 &wi) const;
    std::optional<BsdfSample> Sample(const Vector3 &wo, Float uc, const Point2 &u,
                                     TransportMode mode = TransportMode::Radiance) const;
    Float Pdf(const Vector3 &wo, const Vector3 &wi, TransportMode mode = TransportMode::Radiance) const;
    /// Roughens nearly specular lobes (pbrt-v4-format §5.5).
    void Regularize();
    /// Makes coats use random walks only (CoatedBxdf), as in stock pbrt-v4.
    void UseWalks();
    const Frame &ShadingFrame() const { return frame_; }

  private:
    Frame frame_;
    Lobe lobe_;
    BxdfFlags flags_ = BxdfFlags::None;  ///< of the lobe
};

/// Estimates hemispherical reflectance plus transmittance for wo from a few fixed samples. Exact for diffuse surfaces.
SampledSpectrum EstimateAlbedo(const Bsdf &bsdf, const Vector3 &wo);

}  // namespace pbrt
