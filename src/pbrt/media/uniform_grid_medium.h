#pragma once
#include <optional>
#include <vector>

#include "pbrt/media/medium_spectra.h"
#include "pbrt/media/thermal_emission.h"
#include "pbrt/media/voxels.h"

namespace pbrt {

/// Box of voxels with a density that multiplies absorption and scattering, and optionally an emission factor and a
/// temperature.
class UniformGridMedium final : public Medium {
  public:
    struct Grids {
        glm::ivec3 count{1};             ///< voxels per axis
        std::vector<Float> density;      ///< at least 0
        std::vector<Float> emission;     ///< factor of the emission; empty: 1
        std::vector<Float> temperature;  ///< kelvin; empty: none
    };
    /// `bounds`: of the voxels, in medium space. Without temperatures the emission is that of `spectra`.
    UniformGridMedium(MediumSpectra spectra, Float g, const Transform &renderFromMedium, const Bounds3 &bounds,
                      Grids grids, const ThermalEmission &thermal);
    size_t Bytes() const override;
    MediumOnRay On(const Ray &ray, Float tMax, const SampledWavelengths &lambda) const override;

  private:
    MediumCoefficients Evaluate(MediumOnRay &onRay, Float t) const override;

    MediumSpectra spectra_;
    Grids grids_;
    ThermalEmission thermal_;
    Voxels voxels_;
    MajorantGrid majorants_;
    AffineMap gridFromRender_;
};

}  // namespace pbrt
