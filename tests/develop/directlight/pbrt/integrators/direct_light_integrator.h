#pragma once
#include "pbrt/integrators/pixel_integrator.h"

namespace pbrt {

/// Direct light on the surfaces that the camera sees, estimated by light sampling alone.
class DirectLightIntegrator final : public PixelIntegrator {
  public:
    DirectLightIntegrator(const PathContext &context, int shadowRays, std::unique_ptr<LightSampler> lights);

    void Prepare(PrepareContext &prepare) override { lights_->Prepare(prepare); }
    const LightSampler *Lights() const override { return lights_.get(); }
    SampledSpectrum Li(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler) const override;

  private:
    PathContext context_;
    int shadowRays_;  ///< per camera ray
    std::unique_ptr<LightSampler> lights_;
};

}  // namespace pbrt
