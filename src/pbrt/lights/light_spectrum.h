#pragma once
#include <memory>

#include "pbrt/spectra/spectrum.h"

namespace pbrt {

/// The form in which lights store their emission: one value per nm, shared by all lights of equal emission. May be
/// called from any thread.
std::shared_ptr<const DenseSpectrum> InternSpectrum(const Spectrum &s);

}  // namespace pbrt
