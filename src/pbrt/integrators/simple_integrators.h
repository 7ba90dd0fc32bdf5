#pragma once
#include "pbrt/integrators/pixel_integrator.h"
#include "pbrt/spectra/color_space.h"

namespace pbrt {

/// Path tracing without MIS: light sampling (uniform over the lights) and BSDF sampling can be switched off.
class SimplePathIntegrator final : public PixelIntegrator {
  public:
    SimplePathIntegrator(const IntegratorContext &context, int maxDepth, bool sampleLights, bool sampleBsdf);
    SampledSpectrum Li(CameraRay ray, SampledWavelengths &lambda, Sampler &sampler,
                       std::optional<VisibleSurface> *visible) const override;

  private:
    IntegratorContext context_;
    int maxDepth_;
    bool sampleLights_, sampleBsdf_;
    std::unique_ptr<LightSampler> lights_;
};

/// Scatters into uniformly distributed directions and looks for emission: the slow, plainly right twin of the others.
class RandomWalkIntegrator final : public PixelIntegrator {
  public:
    RandomWalkIntegrator(const IntegratorContext &context, int maxDepth) : context_(context), maxDepth_(maxDepth) {}
    SampledSpectrum Li(CameraRay ray, SampledWavelengths &lambda, Sampler &sampler,
                       std::optional<VisibleSurface> *visible) const override;

  private:
    IntegratorContext context_;
    int maxDepth_;
};

/// Cosine-weighted fraction of the hemisphere that is free up to maxDistance, times a unit illuminant.
class AmbientOcclusionIntegrator final : public PixelIntegrator {
  public:
    AmbientOcclusionIntegrator(const IntegratorContext &context, bool cosineSample, Float maxDistance,
                               const ColorSpace &space);
    SampledSpectrum Li(CameraRay ray, SampledWavelengths &lambda, Sampler &sampler,
                       std::optional<VisibleSurface> *visible) const override;

  private:
    IntegratorContext context_;
    bool cosineSample_;
    Float maxDistance_;
    SpectrumPtr illuminant_;
    Float scale_;
};

}  // namespace pbrt
