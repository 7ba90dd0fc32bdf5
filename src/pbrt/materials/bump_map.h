#pragma once
#include "pbrt/textures/texture.h"

namespace pbrt {

/// Tilts the shading frame as if the surface were moved along its shading normal by a height (world units); the surface
/// itself stays (Blinn 1978).
class BumpMap {
  public:
    explicit BumpMap(FloatTexturePtr height) : height_(std::move(height)) {}
    void Perturb(SurfacePoint &point) const;

  private:
    FloatTexturePtr height_;
};

}  // namespace pbrt
