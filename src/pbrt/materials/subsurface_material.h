#pragma once
#include <variant>

#include "pbrt/materials/material_inputs.h"
#include "pbrt/materials/surface_material.h"

namespace pbrt {

/// Medium below a surface, from coefficients or a reflectance.
class SubsurfaceMatter {
  public:
    static SubsurfaceMatter Coefficients(SpectrumInput sigmaA, SpectrumInput sigmaS) {
        return SubsurfaceMatter(ByCoefficients{std::move(sigmaA), std::move(sigmaS)});
    }
    /// Reflectance of a uniformly lit half space of the medium, and its mean free path.
    static SubsurfaceMatter Reflectance(SpectrumInput reflectance, SpectrumInput meanFreePath) {
        return SubsurfaceMatter(ByReflectance{std::move(reflectance), std::move(meanFreePath)});
    }

    struct Sigmas {
        SampledSpectrum a, s;
    };
    /// `scale` multiplies coefficients or, if they were not given, the mean free path (as in stock).
    Sigmas At(const SurfacePoint &point, const SampledWavelengths &lambda, Float scale,
              const SubsurfaceTable &table) const;

  private:
    struct ByCoefficients {
        SpectrumInput sigmaA, sigmaS;
    };
    struct ByReflectance {
        SpectrumInput reflectance, meanFreePath;
    };
    using Way = std::variant<ByCoefficients, ByReflectance>;
    explicit SubsurfaceMatter(Way way) : way_(std::move(way)) {}
    Way way_;
};

class SubsurfaceMaterial final : public SurfaceMaterial {
  public:
    SubsurfaceMaterial(SubsurfaceMatter matter, Float scale, RoughnessInput roughness,
                       std::shared_ptr<const SubsurfaceTable> table)
        : matter_(std::move(matter)), scale_(scale), roughness_(std::move(roughness)), table_(std::move(table)) {}
    Bsdf GetBsdf(const SurfacePoint &point, SampledWavelengths &) const override {
        return MakeBsdf(point, DielectricBxdf(table_->Eta(), roughness_(point)));
    }
    bool HasBssrdf() const override { return true; }
    std::optional<Bssrdf> GetBssrdf(const SurfacePoint &point, const SampledWavelengths &lambda) const override;

  private:
    SubsurfaceMatter matter_;
    Float scale_;
    RoughnessInput roughness_;
    std::shared_ptr<const SubsurfaceTable> table_;
};

}  // namespace pbrt
