#pragma once
#include "pbrt/bxdfs/bsdf.h"
#include "pbrt/integrators/pixel_integrator.h"
#include "pbrt/spectra/color_space.h"

namespace pbrt {

/// Path tracing without MIS, with optional light sampling (uniform over the lights) and BSDF sampling.
class SimplePathIntegrator final : public PixelIntegrator {
  public:
    SimplePathIntegrator(const PathContext &context, int maxDepth, bool sampleLights, bool sampleBsdf);
    SampledSpectrum Li(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler) const override;

  private:
    /// Direct light from one point on one light, without MIS weight, times the path's throughput.
    SampledSpectrum SampleDirect(const PathVertex &vertex, const SampledSpectrum &beta,
                                 const SampledWavelengths &lambda, int depth, Sampler &sampler) const;
    PathContext context_;
    int maxDepth_;
    bool sampleLights_, sampleBsdf_;
    std::unique_ptr<LightSampler> lights_;
};

/// Scatters into uniform directions and adds emission: slow, but simple enough to validate the others.
class RandomWalkIntegrator final : public PixelIntegrator {
  public:
    RandomWalkIntegrator(const PathContext &context, int maxDepth) : context_(context), maxDepth_(maxDepth) {}
    SampledSpectrum Li(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler) const override;

  private:
    PathContext context_;
    int maxDepth_;
};

/// Single-wavelength path tracing through media and interfaces without light sampling, to validate the others.
/// Scattering surfaces end a path, as in stock pbrt-v4.
class SimpleVolPathIntegrator final : public PixelIntegrator {
  public:
    SimpleVolPathIntegrator(const PathContext &context, int maxDepth) : context_(context), maxDepth_(maxDepth) {}
    SampledSpectrum Li(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler) const override;

  private:
    PathContext context_;
    int maxDepth_;
};

/// Cosine-weighted unoccluded fraction of the hemisphere up to maxDistance, times a unit illuminant.
class AmbientOcclusionIntegrator final : public PixelIntegrator {
  public:
    AmbientOcclusionIntegrator(const PathContext &context, bool cosineSample, Float maxDistance,
                               const ColorSpace &space);
    SampledSpectrum Li(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler) const override;

  private:
    PathContext context_;
    bool cosineSample_;
    Float maxDistance_;
    SpectrumPtr illuminant_;
    Float scale_;
};

}  // namespace pbrt
