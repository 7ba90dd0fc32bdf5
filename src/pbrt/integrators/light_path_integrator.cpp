#include "pbrt/integrators/light_path_integrator.h"

#include "pbrt/core/counters.h"
#include "pbrt/integrators/filtered_splat.h"
#include "pbrt/lightsamplers/simple_light_samplers.h"
#include "pbrt/transport/adjoint_cosine.h"
#include "pbrt/transport/shadow_transmittance.h"

namespace pbrt {

LightPathIntegrator::LightPathIntegrator(const PathContext &context, int maxDepth, std::unique_ptr<LightSampler> lights)
    : context_(context), maxDepth_(maxDepth), lights_(ByPowerUnless(std::move(lights), context.scene.Lights())) {}

SampledSpectrum LightPathIntegrator::Li(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler) const {
    const Scene &scene = context_.scene;
    const RenderPass &pass = start.pass;
    const Float time = start.ray.ray.time, splatUnit = pass.film.SplatUnit();
    ++ThreadCounters().cameraPaths;
    const SampledSpectrum none(0);
    const bool hasMedia = scene.HasMedia();
    SpectralWeights weights;

    /// Adds the radiance `leaving`(wi) of light that leaves `from`, on its side in the medium `mediumTowards`(wi),
    /// where the camera sees it.
    auto splat = [&](const LightSampleContext &from, const Point2 &uLens, auto &&mediumTowards, auto &&leaving) {
        const std::optional<CameraConnection> seen = context_.camera.Connect(from.p, uLens, time);
        if (!seen) return;
        SampledSpectrum L = leaving(seen->wi) * (seen->weight * splatUnit);
        if (!L) return;
        LightLiSample lens;
        lens.wi = seen->wi;
        lens.pLight = seen->p;
        if (hasMedia) {
            Rng rng(Hash(from.p, lens.wi, lens.pLight));
            const ShadowTransmittance through = TraceShadow(scene, from, mediumTowards(seen->wi), lens, lambda, rng);
            if (!through.value) return;
            weights.onlyFirst = lambda.SecondaryTerminated();
            L = L * through.value / weights.Mean(weights.ru * through.rl);
        } else if (scene.Occluded(from, lens)) {
            return;
        }
        if (!pass.keepsSamples) return;
        AddFilteredSplat(pass.film, pass.filter, seen->pFilm, L, lambda);
        Camera::OtherPlaces places;
        for (int i = 0, n = context_.camera.SeenAlsoAt(seen->pFilm, places); i < n; ++i)
            AddFilteredSplat(pass.film, pass.filter, places[static_cast<size_t>(i)], L, lambda);
    };

    LightQuery anywhere;
    anywhere.time = time;
    const std::optional<SampledLight> chosen = lights_->Sample(anywhere, sampler.Get1D());
    const Point2 uPosition = sampler.Get2D(), uDirection = sampler.Get2D(), uFirst = sampler.Get2D();
    if (!chosen || !(chosen->pmf > 0)) return none;
    const LightPart light = scene.Lights()[chosen->light];
    std::optional<LightLeSample> left = light.SampleLe(uPosition, uDirection, lambda);
    if (!left) return none;
    const Float pdfPosition = chosen->pmf * left->pdfPosition;
    const bool hasSurface = left->n != Normal3(0);
    const auto mediumTowards = [&](const Vector3 &w) { return scene.MediumOfLight(chosen->light, left->n, w); };
    if (hasSurface) {
        splat({left->p, left->pError, left->n, left->n, time}, uFirst, mediumTowards, [&](const Vector3 &wi) {
            // The radiance of a surface is the same in all directions in which it shines.
            return light.L(left->p, left->n, left->uv, wi, lambda) ? left->L * (AbsDot(left->n, wi) / pdfPosition)
                                                                   : none;
        });
    }
    SampledSpectrum &beta = weights.beta;
    beta = left->L / (pdfPosition * left->pdfDirection);
    if (hasSurface) beta *= AbsDot(left->n, left->ray.d);

    Ray ray = left->ray;
    ray.time = time;
    ray.medium = mediumTowards(ray.d);
    PathWalk walk(context_, ray);
    for (int depth = 0;;) {
        const PathWalk::Met met = walk.Next();
        if (met == PathWalk::Met::TooManyInterfaces) break;
        if (const Medium *inside = hasMedia ? walk.MediumAhead() : nullptr) {
            const Ray &at = walk.GetRay();
            const Float u = sampler.Get1D();
            Rng rng = NumbersAlong(at, u);
            const MediumEvent event = walk.ThroughMedium(lambda, u, rng, false, weights, [](auto &&, Float) {});
            if (event.kind == MediumEvent::Kind::Absorbed || !beta) break;
            if (event.kind == MediumEvent::Kind::Scattered) {
                if (depth++ == maxDepth_) break;
                ++ThreadCounters().pathVertices;
                const Point3 p = at(event.t);
                const Vector3 wo = -at.d;
                const HenyeyGreenstein &phase = inside->Phase();
                splat(
                    {p, {}, {}, {}, time}, sampler.Get2D(), [&](const Vector3 &) { return at.medium; },
                    [&](const Vector3 &wi) { return beta * phase.P(wo, wi); });
                walk.ScatterInMedium(p, phase.SampleP(wo, sampler.Get2D()).wi);
                continue;
            }
        }
        if (met == PathWalk::Met::Nothing) break;
        if (!walk.FindScattering(lambda)) continue;
        if (depth++ == maxDepth_) break;
        ++ThreadCounters().pathVertices;
        const auto &[point, bsdf] = walk.Vertex();
        const Point2 uLens = sampler.Get2D();
        if (IsNonSpecular(bsdf.Flags()))
            splat(
                LightContextAt(point), uLens, [&](const Vector3 &wi) { return point.MediumTowards(wi); },
                [&](const Vector3 &wi) {
                    return beta * bsdf.F(point.wo, wi, TransportMode::Importance) * AdjointCosine(point, point.wo, wi);
                });
        const Float uComponent = sampler.Get1D();
        const std::optional<BsdfSample> sample =
            bsdf.Sample(point.wo, uComponent, sampler.Get2D(), TransportMode::Importance);
        if (!sample) break;
        beta *= sample->f * (AdjointCosine(point, point.wo, sample->wi) / sample->pdf);
        if (!beta) break;
        walk.Scatter(*sample);
    }
    return none;
}

}  // namespace pbrt
