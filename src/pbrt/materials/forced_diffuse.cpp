#include "pbrt/materials/material_factory.h"

namespace pbrt {

namespace {

class ForcedDiffuseMaterial final : public Material {
  public:
    explicit ForcedDiffuseMaterial(MaterialPtr original) : original_(std::move(original)) {
        SetNeedsFootprint(original_->NeedsFootprint());
    }

    Bsdf GetBsdf(const SurfacePoint &point, SampledWavelengths &lambda) const override {
        const Bsdf bsdf = original_->GetBsdf(point, lambda);
        if (!bsdf) return bsdf;
        const SampledSpectrum albedo = Clamp(EstimateAlbedo(bsdf, point.wo), 0, 1);
        return Bsdf(point.shading.n, point.shading.dpdu, DiffuseBxdf(albedo));
    }
    void PerturbShading(SurfacePoint &point) const override { original_->PerturbShading(point); }

  private:
    MaterialPtr original_;
};

}  // namespace

MaterialPtr ForceDiffuse(MaterialPtr material) {
    if (material->IsInterface() || material->IsMix()) return material;
    return std::make_shared<ForcedDiffuseMaterial>(std::move(material));
}

}  // namespace pbrt
