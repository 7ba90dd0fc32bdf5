#pragma once
#include "pbrt/integrators/pixel_integrator.h"

/// Direct light on the surfaces that the camera sees, estimated by light sampling alone.
class DirectLightIntegrator final : public pbrt::PixelIntegrator {
  public:
    DirectLightIntegrator(const pbrt::PathContext &context, int shadowRays, std::unique_ptr<pbrt::LightSampler> lights);

    void Prepare(pbrt::PrepareContext &prepare) override { lights_->Prepare(prepare); }
    const pbrt::LightSampler *Lights() const override { return lights_.get(); }
    pbrt::SampledSpectrum Li(const pbrt::PathStart &start, pbrt::SampledWavelengths &lambda,
                             pbrt::Sampler &sampler) const override;

  private:
    pbrt::PathContext context_;
    int shadowRays_;  ///< per camera ray
    std::unique_ptr<pbrt::LightSampler> lights_;
};
