#include "pbrt/integrators/path_integrator.h"

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

double PathIntegrator::TracePath(const PrepareContext &prepare, Point2i pixel, int sample, Sampler &sampler) const {
    SampledWavelengths lambda = SampledWavelengths::SampleVisible(sampler.Get1D());
    const CameraSample cs = SampleCamera(prepare.filter, pixel, sampler);
    const std::optional<CameraRay> ray = prepare.camera.GenerateRay(cs, lambda);
    if (!ray) return 0;
    const SampledSpectrum L = ray->weight * FollowBsdf({*ray, pixel, sample}, lambda, sampler);
    const double value = double(L.Average() * cs.filterWeight);
    return std::isfinite(value) ? value : 0;
}

void PathIntegrator::Prepare(PrepareContext &prepare) {
    prepare.tracePath = [&](Point2i pixel, int sample, Sampler &sampler) {
        return TracePath(prepare, pixel, sample, sampler);
    };
    lights_->Prepare(prepare);
    prepare.tracePath = {};
    if (const auto ids = context_.scene.Lights().Environments(); !lights_->ChoosesRegions() && !ids.empty())
        setup_.environment = context_.scene.Lights()[ids[0]].Parent().AsEnvironment()->Table();
    if (directions_) directions_->Prepare(prepare, settings_.maxDepth);
}

}  // namespace pbrt
