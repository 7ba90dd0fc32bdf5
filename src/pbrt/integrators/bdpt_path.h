#pragma once
#include <span>

#include "pbrt/integrators/bdpt_vertex.h"
#include "pbrt/scene/scene.h"

namespace pbrt {

/// MIS weights of bidirectional paths.
///
/// In media the compared densities are geometric: by area, without the free-flight factors (transmittance, and density
/// per length of scattering). Every strategy scatters at every inner vertex, so the latter is common to all. They
/// differ by the transmittance of the connected edge and by the spectral densities (SpectralWeights); both are omitted.
///
/// A weight need not be a ratio of true densities for the sum over strategies to be unbiased. For every path, the
/// weights of all strategies that can sample it must sum to 1. They do, because each is a share of the same sum, which
/// does not depend on null collisions, on the sampled wavelength, or on transmittance estimates. Each strategy divides
/// by its own density, averaged over wavelengths. The cost is some noise: an edge of low transmittance counts as much
/// as a clear one.
class BdptWeights {
  public:
    /// `shooting` selected the lights of light subpaths, `connecting` those of single light vertices.
    BdptWeights(const LightTable &lights, const LightSampler &shooting, const LightSampler &connecting)
        : lights_(lights), shooting_(shooting), connecting_(connecting) {}

    /// Balance heuristic weight of a path sampled with `fromLight` vertices from the light, against all other splits
    /// (Veach 1997, section 10.2). `path`: vertices from light to camera, each with its own subpath's densities.
    /// `cameraPdf`: density by area of the vertex next to the camera, sampled from the camera.
    Float Weight(std::span<const BdptVertex *const> path, int fromLight, Float cameraPdf,
                 const SampledWavelengths &lambda) const;

    /// Density of a light subpath's first vertex: by area; outside the scene: by solid angle.
    Float LightPdf(const BdptVertex &light, const BdptVertex &next) const;

  private:
    /// Density by area of `next` as the second vertex of a light subpath from `light`.
    Float FirstStepPdf(const BdptVertex &light, const BdptVertex &next) const;
    /// LightPdf for a light vertex selected for and sampled from the vertex `from`, which continues to `beyond` and has
    /// this depth from the camera. For an environment light with regions: of the region.
    Float ConnectedLightPdf(const BdptVertex &light, const BdptVertex &from, const BdptVertex &beyond,
                            const SampledWavelengths &lambda, int depth) const;
    const LightTable &lights_;
    const LightSampler &shooting_, &connecting_;
};

}  // namespace pbrt
