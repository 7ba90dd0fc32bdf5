#pragma once
#include "pbrt/integrators/pixel_integrator.h"

namespace pbrt {

/// Where light that went below a surface leaves it again.
struct SubsurfaceExit {
    SurfacePoint point;      ///< wo: its shading normal, the side it leaves to
    Bsdf bsdf;               ///< the exit lobe
    SampledSpectrum weight;  ///< profile over density
};

/// Draws the exit of light that crosses the surface at `entry`. Empty if it does not come out again. Draws the same
/// number of random numbers in any case.
std::optional<SubsurfaceExit> SampleSubsurfaceExit(const Scene &scene, const SurfacePoint &entry, const Bssrdf &bssrdf,
                                                   Sampler &sampler);

}  // namespace pbrt
