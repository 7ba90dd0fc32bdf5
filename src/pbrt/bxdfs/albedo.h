#pragma once
#include "pbrt/bxdfs/bsdf.h"

namespace pbrt {

/// Hemispherical reflectance (and transmittance) by few points, always the same: without error for diffuse surfaces.
SampledSpectrum EstimateAlbedo(const Bsdf &bsdf, const Vector3 &wo);

}  // namespace pbrt
