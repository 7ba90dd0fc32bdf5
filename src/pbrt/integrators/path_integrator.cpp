#include "pbrt/integrators/path_integrator.h"

#include "pbrt/integrators/camera_path.h"
#include "pbrt/integrators/trial.h"

namespace pbrt {

PathIntegrator::PathIntegrator(const PathContext &context, const PathSettings &settings,
                               std::unique_ptr<LightSampler> lights, std::unique_ptr<DirectionSampling> directions)
    : context_(context), settings_(settings), lights_(std::move(lights)), directions_(std::move(directions)),
      setup_{context_, settings_, *lights_, lights_->Observer()}, models_{lights_->Model(), directions_.get()} {}

SampledSpectrum PathIntegrator::Li(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler) const {
    if (directions_) return directions_->Li(setup_, start, lambda, sampler);
    return FollowBsdf(start, lambda, sampler);
}

SampledSpectrum PathIntegrator::FollowBsdf(const CameraPathStart &start, SampledWavelengths &lambda,
                                           Sampler &sampler) const {
    BsdfDirections bsdf;
    if (settings_.tracksMedia)
        return CameraPath<MediaThroughput, BsdfDirections>(setup_, start, lambda, sampler, bsdf).Follow();
    return CameraPath<SurfaceThroughput, BsdfDirections>(setup_, start, lambda, sampler, bsdf).Follow();
}

void PathIntegrator::Prepare(PrepareContext &prepare) {
    prepare.trial = [&] {
        return TraceTrial(prepare, [this](const CameraPathStart &start, SampledWavelengths &lambda, Sampler &sampler) {
            return FollowBsdf(start, lambda, sampler);
        });
    };
    lights_->Prepare(prepare);
    prepare.trial = {};
    if (directions_) directions_->Prepare(prepare, settings_.maxDepth);
}

void PathIntegrator::SaveLearned(StateWriter &writer) const {
    lights_->SaveLearned(writer, true);
    if (directions_) directions_->Save(writer);
}

void PathIntegrator::SaveForOthers(StateWriter &writer) const {
    lights_->SaveLearned(writer, false);
    if (directions_) directions_->SaveForOthers(writer);
}

}  // namespace pbrt
