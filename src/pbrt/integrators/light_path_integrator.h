#pragma once
#include "pbrt/integrators/pixel_integrator.h"

namespace pbrt {

/// Particle tracing: every sample of a pixel sends one path from a light, and every vertex of it that
/// the camera sees adds a splat wherever on the film it is seen (Arvo and Kirk 1990; Veach 1997, section 10.3.4). What
/// the camera sees through mirrors or smooth glass, and lights beyond the scene that it sees directly, stay dark, as in
/// stock pbrt-v4; so does the light of media.
class LightPathIntegrator final : public PixelIntegrator {
  public:
    /// The camera can connect (Camera::CanConnect). `lights` chooses where paths begin, with probabilities that are the
    /// same everywhere; null: by power.
    LightPathIntegrator(const PathContext &context, int maxDepth, std::unique_ptr<LightSampler> lights = nullptr);
    void Prepare(PrepareContext &prepare) override { lights_->Prepare(prepare); }
    const LightSampler *EmissionSampler() const override { return lights_.get(); }
    /// Splats; the radiance it returns is 0.
    SampledSpectrum Li(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler) const override;
    bool Splats() const override { return true; }

  private:
    class LightPath;
    PathContext context_;
    int maxDepth_;
    std::unique_ptr<LightSampler> lights_;
};

}  // namespace pbrt
