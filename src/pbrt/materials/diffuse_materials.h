#pragma once
#include "pbrt/materials/material_inputs.h"
#include "pbrt/materials/surface_material.h"

namespace pbrt {

class DiffuseMaterial final : public SurfaceMaterial {
  public:
    explicit DiffuseMaterial(SpectrumInput reflectance) : reflectance_(std::move(reflectance)) {}
    Bsdf GetBsdf(const SurfacePoint &point, SampledWavelengths &lambda) const override {
        return MakeBsdf(point, DiffuseBxdf(Clamp(reflectance_(point, lambda), 0, 1)));
    }

  private:
    SpectrumInput reflectance_;
};

class DiffuseTransmissionMaterial final : public SurfaceMaterial {
  public:
    DiffuseTransmissionMaterial(SpectrumInput reflectance, SpectrumInput transmittance, Float scale)
        : reflectance_(std::move(reflectance)), transmittance_(std::move(transmittance)), scale_(scale) {}
    Bsdf GetBsdf(const SurfacePoint &point, SampledWavelengths &lambda) const override {
        return MakeBsdf(point, DiffuseTransmissionBxdf(Clamp(scale_ * reflectance_(point, lambda), 0, 1),
                                                       Clamp(scale_ * transmittance_(point, lambda), 0, 1)));
    }

  private:
    SpectrumInput reflectance_, transmittance_;
    Float scale_;
};

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
