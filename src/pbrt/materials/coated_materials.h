#pragma once
#include "pbrt/materials/conductor_material.h"

namespace pbrt {

struct CoatInput {
    RoughnessInput roughness;
    IndexInput eta;
    FloatInput thickness;
    SpectrumInput albedo;  ///< of the medium in the coat
    FloatInput g;
    int maxDepth, samples;

    SampledSpectrum Albedo(const SurfacePoint &point, const SampledWavelengths &lambda) const {
        return albedo.IsBlack() ? SampledSpectrum(0) : Clamp(albedo(point, lambda), 0, 1);
    }
    Float Asymmetry(const SurfacePoint &point) const { return std::clamp(g(point), Float(-1), Float(1)); }

    /// Table for CoatedDiffuseBxdf in place of random walks; null if it does not cover the coat.
    std::shared_ptr<const CoatTable> Table() const {
        const std::optional<Float> index = eta.Constant(), depth = thickness.Constant();
        if (!index || !depth || !albedo.IsBlack() || !roughness.IsIsotropic()) return nullptr;
        std::optional<Float> alpha;
        if (auto constant = roughness.Constant()) alpha = constant->AlphaX();
        return CoatTable::Shared(*index, std::max(*depth, Float(0)), alpha);
    }
};

class CoatedDiffuseMaterial final : public SurfaceMaterial {
  public:
    CoatedDiffuseMaterial(CoatInput coat, SpectrumInput reflectance)
        : coat_(std::move(coat)), reflectance_(std::move(reflectance)), table_(coat_.Table()) {}
    Bsdf GetBsdf(const SurfacePoint &point, SampledWavelengths &lambda) const override {
        DiffuseBxdf base(Clamp(reflectance_(point, lambda), 0, 1));
        DielectricBxdf top(coat_.eta(lambda), coat_.roughness(point));
        CoatedDiffuseBxdf lobe(top, base, coat_.thickness(point), coat_.Albedo(point, lambda), coat_.Asymmetry(point),
                               coat_.maxDepth, coat_.samples);
        if (table_) lobe.UseTable(*table_);
        return MakeBsdf(point, lobe);
    }

  private:
    CoatInput coat_;
    SpectrumInput reflectance_;
    std::shared_ptr<const CoatTable> table_;  ///< null: random walks
};

class CoatedConductorMaterial final : public SurfaceMaterial {
  public:
    CoatedConductorMaterial(CoatInput coat, MetalInput metal, RoughnessInput roughness)
        : coat_(std::move(coat)), metal_(std::move(metal)), roughness_(std::move(roughness)) {}
    Bsdf GetBsdf(const SurfacePoint &point, SampledWavelengths &lambda) const override {
        // Under the coat, the metal's index is relative to the coat's.
        MetalInput::Index index = metal_(point, lambda);
        Float coatEta = coat_.eta(lambda);
        ConductorBxdf base(roughness_(point), index.eta / coatEta, index.k / coatEta);
        DielectricBxdf top(coatEta, coat_.roughness(point));
        return MakeBsdf(point, CoatedConductorBxdf(top, base, coat_.thickness(point), coat_.Albedo(point, lambda),
                                                   coat_.Asymmetry(point), coat_.maxDepth, coat_.samples));
    }

  private:
    CoatInput coat_;
    MetalInput metal_;
    RoughnessInput roughness_;
};

}  // namespace pbrt
