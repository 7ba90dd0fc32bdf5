#pragma once
#include <span>

#include "pbrt/integrators/bdpt_vertex.h"
#include "pbrt/scene/scene.h"

namespace pbrt {

/// What the weights of bidirectional paths need to know.
///
/// In media the densities that are compared are geometric: by area, without the factors of free flight, which are the
/// chance to pass a stretch and the density per length to be scattered behind it. Every strategy scatters at every
/// inner vertex, so the latter is a factor of all their densities; they differ by the transmittance of the one edge
/// that was connected, and by what the wavelengths that could have led the path say of it (SpectralWeights). Both are
/// left out. A weight need not be a ratio of true densities for the sum of all strategies to have the right mean: for
/// every path, given by its vertices, the weights of the strategies that can make it must add up to 1, and they do,
/// because each is a share of the same sum, which depends on nothing else. (It does not depend on null collisions, on
/// the wavelength that led the path, or on estimates of transmittance.) Each strategy by itself divides by its own
/// density, averaged over the wavelengths that could have led. What is lost is some noise: an edge that hardly any
/// light passes counts as much as a clear one.
class BdptWeights {
  public:
    /// `shooting` chose the lights of light subpaths, `connecting` chooses those of single light vertices.
    BdptWeights(const LightTable &lights, const LightSampler &shooting, const LightSampler &connecting)
        : lights_(lights), shooting_(shooting), connecting_(connecting) {}

    /// The weight of the balance heuristic for a path that was made with so many vertices from the light, against all
    /// other numbers with which the same path can be made (Veach 1997, section 10.2). `path`: its vertices from the
    /// light to the camera, each with the densities of its own subpath. `cameraPdf`: the density by area with which the
    /// camera finds the vertex next to it.
    Float Weight(std::span<const BdptVertex *const> path, int fromLight, Float cameraPdf,
                 const SampledWavelengths &lambda) const;

    /// Density of the light's own end of a light subpath: by area; beyond the scene: by solid angle.
    Float LightPdf(const BdptVertex &light, const BdptVertex &next) const;

  private:
    /// Density by area with which a light subpath that begins at `light` continues to `next`.
    Float FirstStepPdf(const BdptVertex &light, const BdptVertex &next) const;
    /// The same as LightPdf for a light vertex that was chosen for, and seen from, the vertex `from`, which goes on to
    /// `beyond` and is the vertex of this depth from the camera. Of a sky that is chosen by parts: of the part.
    Float ConnectedLightPdf(const BdptVertex &light, const BdptVertex &from, const BdptVertex &beyond,
                            const SampledWavelengths &lambda, int depth) const;
    const LightTable &lights_;
    const LightSampler &shooting_, &connecting_;
};

}  // namespace pbrt
