#include "pbrt/integrators/light_path_integrator.h"

#include "pbrt/core/counters.h"
#include "pbrt/integrators/filtered_splat.h"
#include "pbrt/lightsamplers/simple_light_samplers.h"
#include "pbrt/paths/adjoint_cosine.h"

namespace pbrt {

LightPathIntegrator::LightPathIntegrator(const PathContext &context, int maxDepth, std::unique_ptr<LightSampler> lights)
    : context_(context), maxDepth_(maxDepth), lights_(ByPowerUnless(std::move(lights), context.scene.Lights())) {}

SampledSpectrum LightPathIntegrator::Li(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler) const {
    const Scene &scene = context_.scene;
    const RenderPass &pass = *start.pass;
    const Float time = start.ray.ray.time;
    ++ThreadCounters().cameraPaths;
    const SampledSpectrum none(0);

    /// The place of the film that sees `from` and the radiance, in pixels, of light that leaves it by `leaving`.
    auto splat = [&](const LightSampleContext &from, const Point2 &uLens, auto &&leaving) {
        const std::optional<CameraConnection> seen = context_.camera.Connect(from.p, uLens, time);
        if (!seen) return;
        const SampledSpectrum L = leaving(seen->wi) * seen->weight;
        if (!L) return;
        LightLiSample lens;
        lens.wi = seen->wi;
        lens.pLight = seen->p;
        if (scene.Occluded(from, lens)) return;
        if (pass.keepsSamples) AddFilteredSplat(pass.film, pass.filter, seen->pFilm, L, lambda);
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
    if (hasSurface) {
        splat({left->p, left->pError, left->n, left->n, time}, uFirst, [&](const Vector3 &wi) {
            // The radiance of a surface is the same in all directions in which it shines.
            return light.L(left->p, left->n, left->uv, wi, lambda) ? left->L * (AbsDot(left->n, wi) / pdfPosition)
                                                                   : none;
        });
    }
    SampledSpectrum beta = left->L / (pdfPosition * left->pdfDirection);
    if (hasSurface) beta *= AbsDot(left->n, left->ray.d);

    Ray ray = left->ray;
    ray.time = time;
    ray.medium = scene.MediumOfLight(chosen->light);
    PathWalk walk(context_, ray);
    for (int depth = 0; walk.Next() == PathWalk::Met::Surface;) {
        if (!walk.FindScattering(lambda)) continue;
        if (depth++ == maxDepth_) break;
        ++ThreadCounters().pathVertices;
        const auto &[point, bsdf] = walk.Vertex();
        const Point2 uLens = sampler.Get2D();
        if (IsNonSpecular(bsdf.Flags()))
            splat(LightContextAt(point), uLens, [&](const Vector3 &wi) {
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
