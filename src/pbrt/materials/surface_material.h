#pragma once
#include "pbrt/materials/material.h"
#include "pbrt/materials/normal_map.h"

namespace pbrt {

/// A material that may have a normal map: all but mix and interface.
class SurfaceMaterial : public Material {
  public:
    void PerturbShading(SurfacePoint &point) const final {
        if (normalMap_) normalMap_->Perturb(point);
    }
    void SetNormalMap(std::unique_ptr<const NormalMap> map) { normalMap_ = std::move(map); }

  protected:
    template <class Lobe>
    static Bsdf MakeBsdf(const SurfacePoint &point, const Lobe &lobe) {
        return Bsdf(point.shading.n, point.shading.dpdu, lobe);
    }

  private:
    std::unique_ptr<const NormalMap> normalMap_;
};

}  // namespace pbrt
