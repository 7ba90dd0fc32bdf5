#pragma once
#include <memory>

#include "pbrt/integrators/camera_path.h"
#include "pbrt/integrators/photon_map.h"

namespace pbrt {

struct SppmSettings {
    int maxDepth = 5;               ///< scattering events of the whole path
    int photonsPerIteration = -1;   ///< light paths; -1: one per film pixel
    Float radius = 1;               ///< of the first iteration, in scene units
    int seed = 0;                   ///< of the light paths
    bool sampledLightOnly = false;  ///< excludes emission reached only by BSDF sampling
};

/// Stochastic progressive photon mapping (Hachisuka and Jensen 2009). Each sample per pixel is an iteration. Light
/// paths leave photons at surfaces, except at the first. Camera paths are traced to the first diffuse surface: direct
/// light there from light and BSDF sampling, the rest from photons within a radius. The image is the mean over
/// iterations. The radius depends on the iteration only (Knaus and Zwicker 2011), so iterations are independent and a
/// render can be divided. Surfaces only.
class SppmIntegrator final : public PixelIntegrator {
  public:
    SppmIntegrator(const PathContext &context, const SppmSettings &settings, std::unique_ptr<LightSampler> lights,
                   std::unique_ptr<LightSampler> shooting = nullptr);
    void Prepare(PrepareContext &prepare) override {
        lights_->Prepare(prepare);
        shooting_->Prepare(prepare);
    }
    /// One iteration (MaxPassSamples).
    bool Render(const RenderPass &pass) override;
    int MaxPassSamples() const override { return 1; }
    SampledSpectrum Li(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler) const override;
    OnlineModel *Model() override { return lights_->Model(); }
    const LightSampler *Lights() const override { return lights_.get(); }
    const LightSampler *EmissionSampler() const override { return shooting_.get(); }

    /// Radius of an iteration (from 0) relative to the first. Its square shrinks by (i + 2/3)/(i + 1) per step, as
    /// stock's does for a constant number of photons per area and iteration.
    static Float RelativeRadius(int iteration);

  protected:
    /// Photons and camera paths of an iteration share wavelengths.
    std::optional<Float> CommonWavelengths() const override { return uWavelengths_; }

  private:
    void TraceLightPath(const SampledWavelengths &lambda, uint64_t index, std::vector<Photon> &photons) const;
    SampledSpectrum IndirectFromPhotons(const PathVertex &vertex, const SampledWavelengths &lambda,
                                        int scatterings) const;

    class PhotonGathering;

    PathContext context_;
    SppmSettings settings_;
    PathSettings path_;  ///< of camera paths
    std::unique_ptr<LightSampler> lights_, shooting_;
    // Of the current iteration.
    PhotonMap map_;
    Float uWavelengths_ = 0, perArea_ = 0;
    uint64_t seed_ = 0;
};

}  // namespace pbrt
