#pragma once
#include <array>

#include "pbrt/materials/material.h"
#include "pbrt/materials/material_inputs.h"

namespace pbrt {

/// A boundary between media where nothing scatters.
class InterfaceMaterial final : public Material {
  public:
    Bsdf GetBsdf(const SurfacePoint &, SampledWavelengths &) const override { return {}; }
    const Material *Resolve(const SurfacePoint &) const override { return nullptr; }
    bool IsInterface() const override { return true; }
};

/// One of two materials at every point, the second with probability `amount`. The choice is a hash of the point, the
/// direction and `pairId`, so every evaluation of the same hit has the same material.
class MixMaterial final : public Material {
  public:
    /// `pairId` identifies the two operands; it must not depend on their addresses in memory.
    MixMaterial(std::array<MaterialPtr, 2> materials, FloatInput amount, uint64_t pairId);
    Bsdf GetBsdf(const SurfacePoint &point, SampledWavelengths &lambda) const override {
        return Resolve(point)->GetBsdf(point, lambda);
    }
    void PerturbShading(SurfacePoint &point) const override { Resolve(point)->PerturbShading(point); }
    const Material *Resolve(const SurfacePoint &point) const override;
    /// Depth of nesting; 1 if neither operand is a mix.
    int Depth() const { return depth_; }

  private:
    size_t Choose(const SurfacePoint &point) const;

    std::array<MaterialPtr, 2> materials_;
    std::array<const MixMaterial *, 2> mixes_;  ///< the operands that are mixes themselves, else null
    FloatInput amount_;
    uint64_t pairId_;
    int depth_ = 1;
};

}  // namespace pbrt
