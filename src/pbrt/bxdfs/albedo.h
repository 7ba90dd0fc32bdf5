#pragma once
#include "pbrt/bxdfs/bsdf.h"

namespace pbrt {

/// Estimates the hemispherical reflectance plus transmittance for wo from a few fixed sample points. Exact for diffuse
/// surfaces.
SampledSpectrum EstimateAlbedo(const Bsdf &bsdf, const Vector3 &wo);

}  // namespace pbrt
