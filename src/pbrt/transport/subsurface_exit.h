#pragma once
#include "pbrt/samplers/sampler.h"
#include "pbrt/transport/vertex.h"

namespace pbrt {

struct SubsurfaceExit {
    PathVertex vertex;       ///< wo: shading normal on the exit side; the BSDF is the exit lobe
    SampledSpectrum weight;  ///< profile over density
};

/// Samples the exit of light that crosses the surface at `entry`. Empty if there is none. Always uses the same number
/// of random numbers.
std::optional<SubsurfaceExit> SampleSubsurfaceExit(const Scene &scene, const SurfacePoint &entry, const Bssrdf &bssrdf,
                                                   Sampler &sampler);

}  // namespace pbrt
