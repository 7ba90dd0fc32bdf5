#include "pbrt/integrators/simple_integrators.h"

#include "pbrt/core/counters.h"
#include "pbrt/core/error.h"
#include "pbrt/lightsamplers/simple_light_samplers.h"
#include "pbrt/math/warps.h"
#include "pbrt/transport/direct_light.h"
#include "pbrt/transport/medium_track.h"

namespace pbrt {

namespace {

/// Radiance emitted towards the walk at its last hit.
SampledSpectrum Arriving(const PathWalk &walk, const SampledWavelengths &lambda) {
    SampledSpectrum sum(0);
    walk.ForEachEmission(lambda,
                         [&](const SampledSpectrum &Le, LightId, const Point3 &, const Normal3 &) { sum += Le; });
    return sum;
}

struct Direction {
    Vector3 wi{};
    Float pdf = 0;  ///< solid angle
};

/// Samples uniformly the directions into which a vertex can scatter: the half-space on the viewer's side, the one
/// behind the surface, or both.
Direction SampleEvenly(const PathVertex &vertex, const Point2 &u) {
    const auto &[point, bsdf] = vertex;
    const BxdfFlags flags = bsdf.Flags();
    const bool reflects = IsReflective(flags);
    if (reflects && IsTransmissive(flags)) return {SampleUniformSphere(u), UniformSpherePdf()};
    const Vector3 aroundNormal = Frame::FromZ(point.n).FromLocal(SampleUniformHemisphere(u));
    const bool viewerSide = (Dot(point.wo, point.n) > 0) == (Dot(aroundNormal, point.n) > 0);
    return {viewerSide == reflects ? aroundNormal : -aroundNormal, UniformHemispherePdf()};
}

/// Throughput of scattering into a direction not sampled from the BSDF.
SampledSpectrum Throughput(const PathVertex &vertex, const Direction &to) {
    const auto &[point, bsdf] = vertex;
    return bsdf.F(point.wo, to.wi) * (AbsDot(to.wi, point.shading.n) / to.pdf);
}

}  // namespace

SimplePathIntegrator::SimplePathIntegrator(const PathContext &context, int maxDepth, bool sampleLights, bool sampleBsdf)
    : context_(context), maxDepth_(maxDepth), sampleLights_(sampleLights), sampleBsdf_(sampleBsdf),
      lights_(std::make_unique<UniformLightSampler>(context.scene.Lights().ByComponent())) {}

SampledSpectrum SimplePathIntegrator::SampleDirect(const PathVertex &vertex, const SampledSpectrum &beta,
                                                   const SampledWavelengths &lambda, int depth,
                                                   Sampler &sampler) const {
    VertexSelection selection;
    selection.Prepare(*lights_, vertex, lambda, depth);
    const Float uLight = sampler.Get1D();
    ObservedPath unobserved;
    const std::optional<DirectLight> light = SampleDirectLight(
        context_.scene, vertex, selection.lights, lambda, false, uLight, sampler.Get2D(), unobserved,
        [&](const LightLiSample &to, const Point2 &) { return TraceShadowRay(context_.scene, selection.from, to); });
    return light ? beta * light->F() * light->sample.L / light->Pdf() : SampledSpectrum(0);
}

SampledSpectrum SimplePathIntegrator::Li(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler) const {
    PathWalk walk(context_, start.ray, start.visible);
    SampledSpectrum L(0), beta(1);
    ++ThreadCounters().cameraPaths;
    // Without MIS, every light path must be sampled by one technique only: where lights are sampled, emission hit
    // counts only if light sampling cannot reach it.
    bool foundBySampling = false;
    for (int depth = 0; beta; ++depth) {
        const PathWalk::Met met = walk.Next();
        if (met == PathWalk::Met::TooManyInterfaces) break;
        if (!foundBySampling) L += beta * Arriving(walk, lambda);
        if (met == PathWalk::Met::Nothing) break;
        if (depth == maxDepth_) {
            walk.End(lambda);
            break;
        }
        foundBySampling = false;
        if (!walk.FindScattering(lambda)) continue;
        ++ThreadCounters().pathVertices;
        const auto &[point, bsdf] = walk.Vertex();
        if (sampleLights_) L += SampleDirect(walk.Vertex(), beta, lambda, depth + 1, sampler);
        if (sampleBsdf_) {
            const Float uComponent = sampler.Get1D();
            const std::optional<BsdfSample> sample = bsdf.Sample(point.wo, uComponent, sampler.Get2D());
            if (!sample) break;
            beta *= sample->f * (AbsDot(sample->wi, point.shading.n) / sample->pdf);
            foundBySampling = sampleLights_ && !IsSpecular(sample->flags);
            walk.Scatter(*sample);
        } else {
            const Direction to = SampleEvenly(walk.Vertex(), sampler.Get2D());
            beta *= Throughput(walk.Vertex(), to);
            foundBySampling = sampleLights_;
            walk.Leave(to.wi);
        }
    }
    return L;
}

SampledSpectrum RandomWalkIntegrator::Li(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler) const {
    PathWalk walk(context_, start.ray, start.visible);
    SampledSpectrum L(0), beta(1);
    ++ThreadCounters().cameraPaths;
    for (int depth = 0; beta;) {
        const PathWalk::Met met = walk.Next();
        if (met == PathWalk::Met::TooManyInterfaces) break;
        L += beta * Arriving(walk, lambda);
        if (met == PathWalk::Met::Nothing) break;
        if (depth == maxDepth_) {
            walk.End(lambda);
            break;
        }
        if (!walk.FindScattering(lambda)) continue;
        ++depth;
        ++ThreadCounters().pathVertices;
        const Direction to{SampleUniformSphere(sampler.Get2D()), UniformSpherePdf()};
        beta *= Throughput(walk.Vertex(), to);
        walk.Leave(to.wi);
    }
    return L;
}

SampledSpectrum SimpleVolPathIntegrator::Li(const PathStart &start, SampledWavelengths &lambda,
                                            Sampler &sampler) const {
    lambda.TerminateSecondary();
    PathWalk walk(context_, start.ray, start.visible);
    SpectralWeights weights;
    weights.onlyFirst = true;
    SampledSpectrum L(0);
    ++ThreadCounters().cameraPaths;
    for (int depth = 0;;) {
        const PathWalk::Met met = walk.Next();
        if (met == PathWalk::Met::TooManyInterfaces) break;
        if (const Medium *medium = walk.MediumAhead()) {
            const Ray &ray = walk.GetRay();
            const Float u = sampler.Get1D();
            Rng rng = NumbersAlong(ray, u);
            const MediumEvent event = walk.ThroughMedium(
                lambda, u, rng, true, weights, [&](const SampledSpectrum &radiance, Float) { L += radiance; });
            if (event.kind == MediumEvent::Kind::Absorbed) break;
            if (event.kind == MediumEvent::Kind::Scattered) {
                if (depth++ == maxDepth_) break;
                ++ThreadCounters().pathVertices;
                walk.ScatterInMedium(ray(event.t), medium->Phase().SampleP(-ray.d, sampler.Get2D()).wi);
                continue;
            }
        }
        walk.ForEachEmission(lambda, [&](const SampledSpectrum &Le, LightId, const Point3 &, const Normal3 &) {
            L += weights.beta * Le;
        });
        if (met == PathWalk::Met::Nothing) break;
        if (!walk.FindScattering(lambda)) continue;
        const auto &[point, bsdf] = walk.Vertex();
        const Float uComponent = sampler.Get1D();
        if (bsdf.Sample(point.wo, uComponent, sampler.Get2D()))
            throw UserError(
                "Integrator \"simplevolpath\" follows light through media only, and a path has met a surface "
                "that scatters; \"volpath\" renders such scenes.");
        break;
    }
    return L;
}

AmbientOcclusionIntegrator::AmbientOcclusionIntegrator(const PathContext &context, bool cosineSample, Float maxDistance,
                                                       const ColorSpace &space)
    : context_(context), cosineSample_(cosineSample), maxDistance_(maxDistance), illuminant_(space.IlluminantPtr()),
      scale_(1 / SpectrumToPhotometric(*illuminant_)) {}

SampledSpectrum AmbientOcclusionIntegrator::Li(const PathStart &start, SampledWavelengths &lambda,
                                               Sampler &sampler) const {
    PathWalk walk(context_, start.ray, start.visible);
    ++ThreadCounters().cameraPaths;
    do {
        if (walk.Next() != PathWalk::Met::Surface) return SampledSpectrum(0);
    } while (!walk.FindScattering(lambda));
    const SurfacePoint &point = walk.Vertex().point;
    const Normal3 n = FaceForward(point.n, point.wo);
    const Point2 u = sampler.Get2D();
    const Vector3 local = cosineSample_ ? SampleCosineHemisphere(u) : SampleUniformHemisphere(u);
    const Float pdf = cosineSample_ ? CosineHemispherePdf(local.z) : UniformHemispherePdf();  // solid angle
    if (!(pdf > 0)) return SampledSpectrum(0);
    Ray ray = point.SpawnRay(Frame::FromZ(n).FromLocal(local));
    ray.tMax = maxDistance_;
    if (context_.scene.Occluded(ray)) return SampledSpectrum(0);
    return illuminant_->Sample(lambda) * (scale_ * local.z * InvPi / pdf);
}

}  // namespace pbrt
