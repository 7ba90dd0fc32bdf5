#pragma once
#include <memory>

#include "pbrt/spectra/spectrum.h"

namespace pbrt {

/// The form in which lights store their emission: one value per nm, shared by all lights of equal emission. May be
/// called from any thread.
std::shared_ptr<const DenseSpectrum> InternSpectrum(const Spectrum &s);

/// The wavelengths at which power is averaged for light selection (LightCandidate::power).
inline SampledWavelengths PowerWavelengths() { return SampledWavelengths::SampleVisible(Float(0.5)); }

}  // namespace pbrt
