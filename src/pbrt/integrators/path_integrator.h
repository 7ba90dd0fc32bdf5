#pragma once
#include <memory>

#include "pbrt/integrators/direction_sampling.h"

namespace pbrt {

/// Unidirectional path tracing with next-event estimation (CameraPath): path, and volpath with delta tracking of
/// distances and ratio tracking of shadow rays. Both sides of MIS use the light sampler's distribution of the same
/// vertex.
class PathIntegrator final : public PixelIntegrator {
  public:
    /// `directions`: null for BSDF sampling.
    PathIntegrator(const PathContext &context, const PathSettings &settings, std::unique_ptr<LightSampler> lights,
                   std::unique_ptr<DirectionSampling> directions = nullptr);
    PathIntegrator(const PathIntegrator &) = delete;  // setup_ refers to members
    PathIntegrator &operator=(const PathIntegrator &) = delete;

    SampledSpectrum Li(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler) const override;
    void Prepare(PrepareContext &prepare) override;
    OnlineModel *Model() override { return models_.IsEmpty() ? nullptr : &models_; }
    void SaveLearned(StateWriter &writer, bool withLearning) const override {
        lights_->SaveLearned(writer, withLearning);
        if (directions_) directions_->SaveLearned(writer, withLearning);
    }
    const LightSampler *Lights() const override { return lights_.get(); }
    const DirectionSampling *Directions() const override { return directions_.get(); }

  private:
    SampledSpectrum FollowBsdf(const CameraPathStart &start, SampledWavelengths &lambda, Sampler &sampler) const;
    /// PrepareContext::tracePath.
    double TracePath(const PrepareContext &prepare, Point2i pixel, int sample, Sampler &sampler) const;

    PathContext context_;
    PathSettings settings_;
    std::unique_ptr<LightSampler> lights_;
    std::unique_ptr<DirectionSampling> directions_;
    CameraPathSetup setup_;
    OnlineModels models_;
};

}  // namespace pbrt
