#pragma once
#include <memory>
#include <string>

#include "pbrt/bxdfs/measured.h"
#include "pbrt/materials/surface_material.h"

namespace pbrt {

/// Reads a BRDF of the RGL material database (isotropic, or anisotropic over the whole circle). Throws UserError (no
/// location).
std::shared_ptr<const MeasuredBrdf> ReadMeasuredBrdf(const std::string &path);

class MeasuredMaterial final : public SurfaceMaterial {
  public:
    explicit MeasuredMaterial(std::shared_ptr<const MeasuredBrdf> brdf) : brdf_(std::move(brdf)) {}
    Bsdf GetBsdf(const SurfacePoint &point, SampledWavelengths &lambda) const override {
        return MakeBsdf(point, MeasuredBxdf(*brdf_, lambda));
    }

  private:
    std::shared_ptr<const MeasuredBrdf> brdf_;
};

}  // namespace pbrt
