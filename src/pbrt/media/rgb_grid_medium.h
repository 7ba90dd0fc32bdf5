#pragma once
#include <vector>

#include "pbrt/media/medium_spectra.h"
#include "pbrt/media/voxels.h"
#include "pbrt/spectra/color_space.h"

namespace pbrt {

/// Box of RGB voxels for absorption, scattering and emission. Interpolates the uplifted spectra, not the colours.
class RgbGridMedium final : public Medium {
  public:
    struct Grids {
        glm::ivec3 count{1};                                       ///< voxels per axis
        std::vector<RgbUnboundedSpectrum> absorption, scattering;  ///< empty: 1
        std::vector<RgbUnboundedSpectrum> emission;                ///< without the illuminant; empty: 0
        const Spectrum *illuminant = nullptr;                      ///< factor of the emission
        Float scale = 1;                                           ///< of absorption and scattering
        Float emissionScale = 1;
    };
    /// `bounds`: of the voxels, in medium space.
    RgbGridMedium(Float g, const Transform &renderFromMedium, const Bounds3 &bounds, Grids grids);
    size_t Bytes() const override;
    MediumOnRay On(const Ray &ray, Float tMax, const SampledWavelengths &lambda) const override;

  private:
    MediumCoefficients Evaluate(MediumOnRay &onRay, Float t) const override;

    Grids grids_;
    Voxels voxels_;
    MajorantGrid majorants_;
    AffineMap gridFromRender_;
};

}  // namespace pbrt
