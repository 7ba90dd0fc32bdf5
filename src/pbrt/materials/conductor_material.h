#pragma once
#include <optional>

#include "pbrt/materials/material_inputs.h"
#include "pbrt/materials/surface_material.h"

namespace pbrt {

/// Complex index of a metal, given directly or by reflectance.
class MetalInput {
  public:
    struct Index {
        SampledSpectrum eta, k;
    };
    MetalInput(SpectrumInput eta, SpectrumInput k) : first_(std::move(eta)), k_(std::move(k)) {}
    explicit MetalInput(SpectrumInput reflectance) : first_(std::move(reflectance)) {}

    /// For a reflectance r: eta 1 and the k whose normal-incidence Fresnel reflectance is r, clamped to 0.9999.
    Index operator()(const SurfacePoint &point, const SampledWavelengths &lambda) const {
        SampledSpectrum s = first_(point, lambda);
        if (k_) return {s, (*k_)(point, lambda)};
        return {SampledSpectrum(1), Clamp(s, 0, Float(0.9999)).Map([](Float r) { return 2 * std::sqrt(r / (1 - r)); })};
    }

  private:
    SpectrumInput first_;  ///< eta, or the reflectance if there is no k
    std::optional<SpectrumInput> k_;
};

class ConductorMaterial final : public SurfaceMaterial {
  public:
    ConductorMaterial(MetalInput metal, RoughnessInput roughness)
        : metal_(std::move(metal)), roughness_(std::move(roughness)) {}
    Bsdf GetBsdf(const SurfacePoint &point, SampledWavelengths &lambda) const override {
        MetalInput::Index index = metal_(point, lambda);
        return MakeBsdf(point, ConductorBxdf(roughness_(point), index.eta, index.k));
    }

  private:
    MetalInput metal_;
    RoughnessInput roughness_;
};

}  // namespace pbrt
