#pragma once
#include <optional>

#include "pbrt/materials/bump_map.h"
#include "pbrt/materials/material.h"
#include "pbrt/materials/normal_map.h"

namespace pbrt {

/// Base of all materials except mix and interface. May have a normal or bump map; of both, the normal map is used.
class SurfaceMaterial : public Material {
  public:
    SurfaceMaterial() { SetPlain(true); }
    void PerturbShading(SurfacePoint &point) const final {
        if (normalMap_) normalMap_->Perturb(point);
        else if (bumpMap_) bumpMap_->Perturb(point);
    }
    void SetNormalMap(std::unique_ptr<const NormalMap> map) {
        normalMap_ = std::move(map);
        SetPlain(false);
    }
    void SetBumpMap(BumpMap map) {
        bumpMap_ = std::move(map);
        SetPlain(false);
    }

  protected:
    template <class Lobe>
    static Bsdf MakeBsdf(const SurfacePoint &point, const Lobe &lobe) {
        return Bsdf(point.shading.n, point.shading.dpdu, lobe);
    }

  private:
    std::unique_ptr<const NormalMap> normalMap_;
    std::optional<BumpMap> bumpMap_;
};

}  // namespace pbrt
