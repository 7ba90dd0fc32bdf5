#pragma once
#include <array>

#include "pbrt/materials/material.h"
#include "pbrt/materials/material_inputs.h"

namespace pbrt {

class InterfaceMaterial final : public Material {
  public:
    Bsdf GetBsdf(const SurfacePoint &, SampledWavelengths &) const override { return {}; }
    const Material *Resolve(const SurfacePoint &) const override { return nullptr; }
    bool IsInterface() const override { return true; }
};

/// Chooses one of two materials per point, the second with probability `amount`. A hash of point, direction and
/// `pairId` makes repeated evaluations of a hit consistent.
class MixMaterial final : public Material {
  public:
    /// `pairId` identifies the operands independently of memory addresses.
    MixMaterial(std::array<MaterialPtr, 2> materials, FloatInput amount, uint64_t pairId);
    Bsdf GetBsdf(const SurfacePoint &point, SampledWavelengths &lambda) const override {
        return Resolve(point)->GetBsdf(point, lambda);
    }
    void PerturbShading(SurfacePoint &point) const override { Resolve(point)->PerturbShading(point); }
    const Material *Resolve(const SurfacePoint &point) const override;
    /// Nesting depth; 1 if neither operand is a mix.
    int Depth() const { return depth_; }

  private:
    size_t Choose(const SurfacePoint &point) const;

    std::array<MaterialPtr, 2> materials_;
    std::array<const MixMaterial *, 2> mixes_;  ///< operands that are mixes, else null
    FloatInput amount_;
    uint64_t pairId_;
    int depth_ = 1;
};

}  // namespace pbrt
