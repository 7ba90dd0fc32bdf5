#include "pbrt/transport/path_walk.h"

#include <type_traits>
#include <utility>

namespace pbrt {

PathWalk::Met PathWalk::Next() {
    const Scene &scene = context_.scene;
    const bool meets = std::exchange(fromCamera_, false) ? scene.IntersectFromCamera(ray_, &vertex_.point)
                                                         : scene.Intersect(ray_, &vertex_.point);
    if (meets) return passed_ > MaxPassed ? Met::TooManyInterfaces : Met::Surface;
    left_ = true;
    return Met::Nothing;
}

bool PathWalk::FindScattering(SampledWavelengths &lambda) {
    SurfacePoint &point = vertex_.point;
    FindFootprint();
    // Constructed in place: copying recently written small fields costs as much as constructing.
    static_assert(std::is_trivially_destructible_v<Bsdf>);
    new (&vertex_.bsdf) Bsdf(ComputeBsdf(context_.scene, point, lambda));
    if (vertex_.bsdf) {
        passed_ = 0;
        if (visible_ && !*visible_) RecordVisible(lambda);
        return true;
    }
    if (passed_++ == 0) start_ = ray_.o;
    const Vector3 d = ray_.d;
    ray_ = point.SpawnRay(d);
    differential_.rxOrigin += differential_.rxDirection * point.t;
    differential_.ryOrigin += differential_.ryDirection * point.t;
    return false;
}

bool PathWalk::FindScattering(SampledWavelengths &lambda, SpectralWeights &weights) {
    const SampledWavelengths before = lambda;
    const bool scatters = FindScattering(lambda);
    const bool dependsOnFirst = weights.ru.MinComponent() != weights.ru.MaxComponent();
    if (lambda.SecondaryTerminated() && !before.SecondaryTerminated() && dependsOnFirst) {
        lambda = before;
        weights.EndSecondary();
    }
    weights.onlyFirst = lambda.SecondaryTerminated();
    return scatters;
}

std::optional<ReachedVertex> PathWalk::NextVertex(SampledWavelengths &lambda, SpectralWeights &weights, Rng &rng) {
    return NextVertex(
        lambda, weights, [&] { return ThroughMedium(lambda, rng, weights); }, [](Met) {});
}

MediumEvent PathWalk::ThroughMedium(const SampledWavelengths &lambda, Rng &rng, SpectralWeights &weights) const {
    const Float u = rng.Uniform();
    return TrackMedium(MediumOnRayAhead(lambda), u, rng, false, weights, [](const SampledSpectrum &, Float) {});
}

void PathWalk::RecordVisible(const SampledWavelengths &lambda) const {
    SurfacePoint point = vertex_.point;
    // Walks without footprints have marked their differentials invalid.
    RayDifferential differential = differential_;
    differential.valid = startsWithDifferential_;
    ComputeFootprint(point, differential, context_.camera, context_.samplesPerPixel);
    const Normal3 n = FaceForward(point.n, point.wo), ns = FaceForward(point.shading.n, point.wo);
    const SampledSpectrum albedo = EstimateAlbedo(vertex_.bsdf, point.wo);
    *visible_ = VisibleSurface{point.p, n, ns, point.uv, point.dpdx, point.dpdy, point.time, albedo, lambda};
}

void PathWalk::Scatter(const BsdfSample &sample) {
    const SurfacePoint &point = vertex_.point;
    if (differential_.valid) {
        if (!IsSpecular(sample.flags)) differential_.valid = false;
        else if (IsTransmissive(sample.flags))
            differential_ = TransmitDifferential(point, differential_, sample.wi, sample.eta);
        else differential_ = ReflectDifferential(point, differential_, sample.wi);
    }
    ray_ = point.SpawnRay(sample.wi);
}

std::optional<BsdfSample> PathWalk::SampleScattering(Rng &rng) {
    const Float uc = rng.Uniform();
    const std::optional<BsdfSample> sample = vertex_.bsdf.Sample(vertex_.point.wo, uc, rng.Uniform2());
    if (sample) Scatter(*sample);
    return sample;
}

void PathWalk::Leave(const Vector3 &wi) {
    differential_.valid = false;
    ray_ = vertex_.point.SpawnRay(wi);
}

void PathWalk::ScatterInMedium(const Point3 &p, const Vector3 &wi) {
    differential_.valid = false;
    ray_.o = p;
    ray_.d = wi;
    passed_ = 0;
    left_ = false;
    visible_ = nullptr;  // no surface is visible there
}

/// Computes the footprint only if used: by the material, or at the next surface of a specular path.
void PathWalk::FindFootprint() {
    SurfacePoint &point = vertex_.point;
    if (!context_.needsFootprints) differential_.valid = false;
    else if (differential_.valid || context_.scene.NeedsFootprintAt(point))
        ComputeFootprint(point, differential_, context_.camera, context_.samplesPerPixel);
}

std::optional<SubsurfaceExit> SampleSubsurfaceExit(const Scene &scene, const SurfacePoint &entry, const Bssrdf &bssrdf,
                                                   Sampler &sampler) {
    const Float uAxis = sampler.Get1D();
    const Point2 uProbe = sampler.Get2D();
    const Float uCrossing = sampler.Get1D();
    const std::optional<Bssrdf::Probe> probe = bssrdf.SampleProbe(uAxis, uProbe);
    if (!probe) return {};
    std::optional<Scene::Crossing> crossing =
        scene.SampleCrossing(probe->from, probe->to, entry.time, entry.material, uCrossing);
    if (!crossing) return {};
    SubsurfaceExit exit;
    auto &[point, bsdf] = exit.vertex;
    point = crossing->point;
    point.wo = point.shading.n;
    // The probe ray carried no medium, so surfaces without interface have none set.
    if (point.insideMedium == point.outsideMedium) point.insideMedium = point.outsideMedium = entry.outsideMedium;
    const Float pdf = bssrdf.Pdf(point.p, point.n) / Float(crossing->count);  // area
    if (!(pdf > 0)) return {};
    exit.weight = bssrdf.Profile(Distance(entry.p, point.p)) / pdf;
    if (!exit.weight) return {};
    bsdf = Bsdf(point.shading.n, point.shading.dpdu, bssrdf.ExitLobe());
    return exit;
}

}  // namespace pbrt
