#pragma once
#include "pbrt/materials/material_inputs.h"
#include "pbrt/materials/surface_material.h"

namespace pbrt {

class DielectricMaterial final : public SurfaceMaterial {
  public:
    DielectricMaterial(IndexInput eta, RoughnessInput roughness)
        : eta_(std::move(eta)), roughness_(std::move(roughness)) {}
    Bsdf GetBsdf(const SurfacePoint &point, SampledWavelengths &lambda) const override {
        return MakeBsdf(point, DielectricBxdf(eta_(lambda), roughness_(point)));
    }

  private:
    IndexInput eta_;
    RoughnessInput roughness_;
};

class ThinDielectricMaterial final : public SurfaceMaterial {
  public:
    explicit ThinDielectricMaterial(IndexInput eta) : eta_(std::move(eta)) {}
    Bsdf GetBsdf(const SurfacePoint &point, SampledWavelengths &lambda) const override {
        return MakeBsdf(point, ThinDielectricBxdf(eta_(lambda)));
    }

  private:
    IndexInput eta_;
};

}  // namespace pbrt
