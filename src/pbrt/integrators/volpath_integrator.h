#pragma once
#include <memory>

#include "pbrt/integrators/path_integrator.h"
#include "pbrt/paths/medium_track.h"

namespace pbrt {

/// Unidirectional path tracing through media with next-event estimation, at surfaces and inside media. Distances in
/// media are drawn by delta tracking, shadow rays are weakened by ratio tracking; light sampling, scattering and the
/// wavelengths that could have drawn a distance are combined by the balance heuristic (SpectralWeights). Scenes without
/// media are rendered by PathIntegrator. With a guide, paths end in media by what was found there as well; directions
/// are learned and guided at surfaces.
class VolPathIntegrator final : public GuidedPixelIntegrator {
  public:
    using GuidedPixelIntegrator::GuidedPixelIntegrator;
    SampledSpectrum Li(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler) const override;

  private:
    template <class Bounces>
    struct Path;
};

/// Path tracing through media and interface surfaces without light sampling, at one wavelength: simple enough to check
/// the others with. Surfaces that scatter end a path, as in stock pbrt-v4.
class SimpleVolPathIntegrator final : public PixelIntegrator {
  public:
    SimpleVolPathIntegrator(const PathContext &context, int maxDepth) : context_(context), maxDepth_(maxDepth) {}
    SampledSpectrum Li(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler) const override;

  private:
    PathContext context_;
    int maxDepth_;
};

}  // namespace pbrt
