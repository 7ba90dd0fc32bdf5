#pragma once
#include "pbrt/spectra/spectrum.h"

namespace pbrt {

/// Emission of a black body at temperature (T - offset) * factor, normalised to its peak. None at 100 K and below.
struct ThermalEmission {
    Float offset = 0;  ///< kelvin
    Float factor = 1;
    Float scale = 1;  ///< of the emission

    SampledSpectrum At(Float temperature, const SampledWavelengths &lambda) const {
        const Float kelvin = (temperature - offset) * factor;
        constexpr Float kCold = 100;
        if (!(kelvin > kCold)) return SampledSpectrum(0);
        return scale * BlackbodySpectrum(kelvin).Sample(lambda);
    }
};

}  // namespace pbrt
