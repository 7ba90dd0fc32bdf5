#pragma once
#include <optional>
#include <span>
#include <variant>

#include "pbrt/bxdfs/bxdf.h"
#include "pbrt/bxdfs/conductor.h"
#include "pbrt/bxdfs/dielectric.h"
#include "pbrt/bxdfs/diffuse.h"
#include "pbrt/bxdfs/hair.h"
#include "pbrt/bxdfs/layered.h"
#include "pbrt/bxdfs/measured.h"
#include "pbrt/bxdfs/normalized_fresnel.h"
#include "pbrt/math/frame.h"

namespace pbrt {

/// One lobe set as a value (std::monostate: no scattering surface, the ray passes) and its shading frame. Directions in
/// rendering space, pointing away from the surface. Densities by solid angle. Lives on the stack.
class Bsdf {
  public:
    using Lobe = std::variant<std::monostate, DiffuseBxdf, DiffuseTransmissionBxdf, ConductorBxdf, DielectricBxdf,
                              ThinDielectricBxdf, CoatedDiffuseBxdf, CoatedConductorBxdf, HairBxdf, MeasuredBxdf,
                              NormalizedFresnelBxdf>;

    Bsdf() = default;
    template <class L>
    Bsdf(const Normal3 &ns, const Vector3 &dpdus, const L &lobe) : frame_(Frame::FromXZ(dpdus, ns)), lobe_(lobe) {}

    explicit operator bool() const { return !std::holds_alternative<std::monostate>(lobe_); }
    BxdfFlags Flags() const;
    /// True if F follows a glossy lobe, alone or as part of a coat: then the choice of a direction had better follow it
    /// too.
    bool IsDirectional() const;
    /// F up to a factor that hardly depends on wi, as a mean over wavelengths, cheap and deterministic (no random walks
    /// in layers, no metal's Fresnel term): for choosing among directions, not for radiance.
    void ApproximateF(const Vector3 &wo, std::span<const Vector3> wi, Float *f) const;
    /// f(wo, wi); 0 for specular lobes.
    SampledSpectrum F(const Vector3 &wo, const Vector3 &wi, TransportMode mode = TransportMode::Radiance) const;
    std::optional<BsdfSample> Sample(const Vector3 &wo, Float uc, const Point2 &u,
                                     TransportMode mode = TransportMode::Radiance,
                                     ReflTransFlags which = ReflTransFlags::All) const;
    Float Pdf(const Vector3 &wo, const Vector3 &wi, TransportMode mode = TransportMode::Radiance,
              ReflTransFlags which = ReflTransFlags::All) const;
    /// Roughens nearly specular lobes (pbrt-v4-format §5.5).
    void Regularize();
    const Frame &ShadingFrame() const { return frame_; }

  private:
    Frame frame_;
    Lobe lobe_;
};

}  // namespace pbrt
