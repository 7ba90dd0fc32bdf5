#pragma once
#include "pbrt/textures/texture.h"

namespace pbrt {

/// Perturbs the shading frame as by a displacement along the shading normal (world units), without moving the surface
/// (Blinn 1978).
class BumpMap {
  public:
    explicit BumpMap(FloatTexturePtr height) : height_(std::move(height)) {}
    void Perturb(SurfacePoint &point) const;

  private:
    FloatTexturePtr height_;
};

}  // namespace pbrt
