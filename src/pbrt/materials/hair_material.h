#pragma once
#include <variant>

#include "pbrt/materials/material_inputs.h"
#include "pbrt/materials/surface_material.h"

namespace pbrt {

/// The ways to say how much a fibre absorbs (by its radius).
class HairColor {
  public:
    static HairColor Absorption(SpectrumInput sigmaA) { return HairColor(ByAbsorption{std::move(sigmaA)}); }
    /// Of a mass of hair.
    static HairColor Reflectance(SpectrumInput reflectance) { return HairColor(ByReflectance{std::move(reflectance)}); }
    /// Concentrations, negative ones count 0.
    static HairColor Pigments(FloatInput eumelanin, FloatInput pheomelanin);

    SampledSpectrum operator()(const SurfacePoint &point, Float betaN, const SampledWavelengths &lambda) const;

  private:
    struct ByAbsorption {
        SpectrumInput sigmaA;
    };
    struct ByReflectance {
        SpectrumInput reflectance;
    };
    struct ByPigments {
        FloatInput eumelanin, pheomelanin;
    };
    using Way = std::variant<ByAbsorption, ByReflectance, ByPigments>;
    explicit HairColor(Way way) : way_(std::move(way)) {}
    Way way_;
};

/// A fibre seen so close that rays meet it at different offsets across its width, which is v.
class HairMaterial final : public SurfaceMaterial {
  public:
    HairMaterial(HairColor color, FloatInput eta, FloatInput betaM, FloatInput betaN, FloatInput alpha)
        : color_(std::move(color)),
          eta_(std::move(eta)),
          betaM_(std::move(betaM)),
          betaN_(std::move(betaN)),
          alpha_(std::move(alpha)) {}
    Bsdf GetBsdf(const SurfacePoint &point, SampledWavelengths &lambda) const override;

  private:
    HairColor color_;
    FloatInput eta_, betaM_, betaN_, alpha_;
};

}  // namespace pbrt
