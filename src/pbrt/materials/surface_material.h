#pragma once
#include <memory>

#include "pbrt/images/image.h"
#include "pbrt/materials/material.h"
#include "pbrt/textures/texture.h"

namespace pbrt {

/// Perturbs the shading frame as by a displacement along the shading normal (world units), without moving the surface
/// (Blinn 1978).
void ApplyBumpMap(const FloatTexture &height, SurfacePoint &point);

/// Rotates the shading frame to the normal of an image with channels R, G, B = (n + 1) / 2, x along dpdu and z along
/// the shading normal. Repeats; v = 0 is the bottom row. dpdu and dpdv stay orthogonal to the normal and keep their
/// lengths.
void ApplyNormalMap(const Image &image, SurfacePoint &point);

/// Base of all materials except mix and interface. May have a normal or bump map; of both, the normal map is used.
class SurfaceMaterial : public Material {
  public:
    SurfaceMaterial() { SetPlain(true); }
    void PerturbShading(SurfacePoint &point) const final {
        if (normalMap_) ApplyNormalMap(*normalMap_, point);
        else if (bumpMap_) ApplyBumpMap(*bumpMap_, point);
    }
    void SetNormalMap(std::shared_ptr<const Image> map) {
        normalMap_ = std::move(map);
        SetPlain(false);
    }
    void SetBumpMap(FloatTexturePtr height) {
        bumpMap_ = std::move(height);
        SetPlain(false);
    }

  private:
    std::shared_ptr<const Image> normalMap_;
    FloatTexturePtr bumpMap_;
};

/// Material whose lobe at a point is `lobe(point, lambda)`.
template <class F>
class LobeMaterial final : public SurfaceMaterial {
  public:
    explicit LobeMaterial(F lobe) : lobe_(std::move(lobe)) {}
    Bsdf GetBsdf(const SurfacePoint &point, SampledWavelengths &lambda) const override {
        return Bsdf(point.shading.n, point.shading.dpdu, lobe_(point, lambda));
    }

  private:
    F lobe_;
};

template <class F>
std::shared_ptr<SurfaceMaterial> MakeLobeMaterial(F lobe) {
    return std::make_shared<LobeMaterial<F>>(std::move(lobe));
}

}  // namespace pbrt
