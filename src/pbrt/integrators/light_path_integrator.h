#pragma once
#include "pbrt/integrators/pixel_integrator.h"

namespace pbrt {

/// Particle tracing (Arvo and Kirk 1990; Veach 1997, section 10.3.4). Every pixel sample traces one path from a light;
/// vertices visible to the camera add splats at their film position. As in stock pbrt-v4, objects visible through
/// mirrors or smooth glass, directly visible lights outside the scene, and medium emission stay dark.
class LightPathIntegrator final : public PixelIntegrator {
  public:
    /// The camera must support Camera::CanConnect. `lights` selects where paths start, with position-independent
    /// probabilities; null: by power.
    LightPathIntegrator(const PathContext &context, int maxDepth, std::unique_ptr<LightSampler> lights = nullptr);
    void Prepare(PrepareContext &prepare) override { lights_->Prepare(prepare); }
    const LightSampler *EmissionSampler() const override { return lights_.get(); }
    /// Splats; returns radiance 0.
    SampledSpectrum Li(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler) const override;
    bool Splats() const override { return true; }

  private:
    class LightPath;
    PathContext context_;
    int maxDepth_;
    std::unique_ptr<LightSampler> lights_;
};

}  // namespace pbrt
