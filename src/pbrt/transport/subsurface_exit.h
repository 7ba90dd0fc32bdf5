#pragma once
#include "pbrt/samplers/sampler.h"
#include "pbrt/transport/vertex.h"

namespace pbrt {

/// Where light that went below a surface leaves it again, and by what factor.
struct SubsurfaceExit {
    PathVertex vertex;       ///< wo: its shading normal, the side it leaves to; the BSDF is the exit lobe
    SampledSpectrum weight;  ///< profile over density
};

/// Draws the exit of light that crosses the surface at `entry`. Empty if it does not come out again. Uses the same
/// number of random numbers in any case.
std::optional<SubsurfaceExit> SampleSubsurfaceExit(const Scene &scene, const SurfacePoint &entry, const Bssrdf &bssrdf,
                                                   Sampler &sampler);

}  // namespace pbrt
