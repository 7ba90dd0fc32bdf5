#pragma once
#include <memory>

#include "pbrt/integrators/path_guide.h"
#include "pbrt/integrators/pixel_integrator.h"
#include "pbrt/lightsamplers/light_learner.h"

namespace pbrt {

struct PathSettings {
    int maxDepth = 5;         ///< scattering events; 0: emission only, 1: direct light
    bool regularize = false;  ///< roughen specular lobes after the first non-specular bounce
    bool subsurface =
        false;  ///< follow light below surfaces (volpath; to path they are clear dielectrics, as in stock)
    /// Light sampling reaches through interface surfaces (volpath, with a scene whose shadow rays pass them; with path
    /// they block shadow rays, as in stock).
    bool seesThroughInterfaces = false;
    /// Leaves out emission that only BSDF sampling can find: lights seen directly or in a mirror, caustics. It does not
    /// depend on the light sampler; without it a measurement of light samplers is free of its noise.
    bool sampledLightOnly = false;
    /// Least probability with which roulette lets a path go on: 0 as in stock, 1 for no roulette.
    Float minSurvival = 0;
    std::optional<GuideParams> guide{};  ///< paths are guided
};

/// Path tracing from the camera with next-event estimation: light sampler and guide, and how they learn.
class GuidedPixelIntegrator : public PixelIntegrator {
  public:
    GuidedPixelIntegrator(const PathContext &context, const PathSettings &settings,
                          std::unique_ptr<LightSampler> lights)
        : context_(context),
          settings_(settings),
          lights_(std::move(lights)),
          learner_(lights_->Learner()),
          guide_(settings.guide ? std::make_unique<PathGuide>(*settings.guide, learner_) : nullptr) {}

    void Prepare(PrepareContext &prepare) override {
        lights_->Prepare(prepare);
        if (guide_) guide_->Prepare(prepare, settings_.maxDepth);
    }
    LightLearner *Learner() override { return guide_ ? guide_.get() : learner_; }
    void SaveLearned(StateWriter &writer) const override {
        lights_->SaveLearned(writer, true);
        if (guide_) guide_->Save(writer);
    }
    void SaveForOthers(StateWriter &writer) const override {
        lights_->SaveLearned(writer, false);
        if (guide_) guide_->SaveForOthers(writer);
    }
    const LightSampler *Lights() const override { return lights_.get(); }
    const PathGuide *Guide() const override { return guide_.get(); }

  protected:
    PathContext context_;
    PathSettings settings_;
    std::unique_ptr<LightSampler> lights_;
    LightLearner *learner_;  ///< of the light sampler
    std::unique_ptr<PathGuide> guide_;
};

/// Unidirectional path tracing with next-event estimation; BSDF and light sampling combined by the power heuristic.
/// Both sides of the combination use the light sampler's distribution of the same vertex. With a guide, a part of
/// the bounces follows what it learned.
class PathIntegrator final : public GuidedPixelIntegrator {
  public:
    using GuidedPixelIntegrator::GuidedPixelIntegrator;
    SampledSpectrum Li(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler) const override;

  private:
    template <class Bounces>
    SampledSpectrum SampleDirect(const PathVertex &vertex, const LightDistribution &lights, const Bounces &bounces,
                                 const SampledWavelengths &lambda, Sampler &sampler,
                                 LightLearner::PathPlaces &places) const;
    /// `bounces` chooses directions and knows their densities.
    template <class Bounces>
    SampledSpectrum Follow(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler,
                           Bounces &&bounces) const;
};

}  // namespace pbrt
