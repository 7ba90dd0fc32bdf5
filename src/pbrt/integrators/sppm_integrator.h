#pragma once
#include <memory>

#include "pbrt/integrators/camera_path.h"
#include "pbrt/integrators/photon_map.h"

namespace pbrt {

struct SppmSettings {
    int maxDepth = 5;               ///< scattering events of the whole path
    int photonsPerIteration = -1;   ///< light paths; -1: as many as the film has pixels
    Float radius = 1;               ///< of the first iteration, in units of the scene
    int seed = 0;                   ///< chooses among sets of light paths
    bool sampledLightOnly = false;  ///< leaves out emission that only BSDF sampling can find
};

/// Stochastic progressive photon mapping (Hachisuka and Jensen 2009). An iteration is a sample of every pixel: light
/// paths from the lights leave photons where they meet surfaces, except at the first one; camera paths are
/// followed to the first diffuse surface, whose direct light comes from light and BSDF sampling, and all other light
/// from the photons within a radius. The mean over iterations is the picture. The radius shrinks from iteration to
/// iteration and depends on nothing else (Knaus and Zwicker 2011), so that iterations are independent and a render can
/// be divided like any other. Surfaces only.
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

    /// The radius of an iteration, counted from 0, over that of the first one. Its square shrinks by (i + 2/3)/(i + 1)
    /// at each step, as stock's does where the same number of photons falls on every area in every iteration.
    static Float RelativeRadius(int iteration);

  protected:
    /// Photons and camera paths of an iteration have the same wavelengths.
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
    // Of the iteration that is rendered.
    PhotonMap map_;
    Float uWavelengths_ = 0, perArea_ = 0;
    uint64_t seed_ = 0;
};

}  // namespace pbrt
