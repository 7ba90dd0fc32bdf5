#pragma once
#include <memory>

#include "pbrt/spectra/spectrum.h"

namespace pbrt {

/// Emission as one value per nm, shared by all lights of equal emission. Thread-safe.
std::shared_ptr<const DenseSpectrum> InternSpectrum(const Spectrum &s);

}  // namespace pbrt
