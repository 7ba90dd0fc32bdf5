#pragma once
#include <variant>

#include "pbrt/materials/material_inputs.h"
#include "pbrt/materials/surface_material.h"

namespace pbrt {

/// Absorption of a fibre per radius, from absorption, reflectance or pigments.
class HairColor {
  public:
    static HairColor Absorption(SpectrumInput sigmaA) { return HairColor(ByAbsorption{std::move(sigmaA)}); }
    /// `reflectance`: of a mass of hair.
    static HairColor Reflectance(SpectrumInput reflectance) { return HairColor(ByReflectance{std::move(reflectance)}); }
    /// Pigment concentrations; negative ones count as 0.
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

/// Hair in the near field; the offset across the fibre is the surface parameter v.
class HairMaterial final : public SurfaceMaterial {
  public:
    HairMaterial(HairColor color, FloatInput eta, FloatInput betaM, FloatInput betaN, FloatInput alpha)
        : color_(std::move(color)), eta_(std::move(eta)), betaM_(std::move(betaM)), betaN_(std::move(betaN)),
          alpha_(std::move(alpha)) {}
    Bsdf GetBsdf(const SurfacePoint &point, SampledWavelengths &lambda) const override;

  private:
    HairColor color_;
    FloatInput eta_, betaM_, betaN_, alpha_;
};

}  // namespace pbrt
