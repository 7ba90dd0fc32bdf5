#include "pbrt/integrators/path_integrator.h"

#include <array>

#include "pbrt/core/counters.h"
#include "pbrt/integrators/path_common.h"
#include "pbrt/integrators/subsurface_exit.h"
#include "pbrt/integrators/visible_surface.h"
#include "pbrt/math/warps.h"

namespace pbrt {

SampledSpectrum PathIntegrator::SampleDirect(const SurfacePoint &point, const Bsdf &bsdf, const LightQuery &query,
                                             const SampledWavelengths &lambda, Sampler &sampler) const {
    // Both random inputs are drawn whatever happens, so that dimensions stay aligned between samples.
    Float uSelect = sampler.Get1D();
    Point2 uLight = sampler.Get2D();
    Float uGate = gate_ ? sampler.Get1D() : 0;
    std::optional<SampledLight> selected = lights_->Sample(query, uSelect);
    if (!selected) {
        ++ThreadCounters().zeroLightSamples;
        return SampledSpectrum(0);
    }
    auto nothingFound = [&] {
        if (learner_) learner_->Found(query, *selected, SampledSpectrum(0));
        return SampledSpectrum(0);
    };
    const Light &light = context_.scene.Lights()[selected->light];
    std::optional<LightLiSample> sample =
        light.SampleLi(ScatteringContextAt(context_.scene, point, bsdf), uLight, lambda, true);
    if (!sample || !sample->L || !(sample->pdf > 0)) return nothingFound();

    const Float cosine = AbsDot(sample->wi, point.shading.n);
    SampledSpectrum f = bsdf.F(point.wo, sample->wi) * cosine;
    if (!f) return nothingFound();
    Float traced = 1;
    if (gate_) {
        traced = gate_->TraceProbability(query, selected->light, sample->pLight);
        if (uGate >= traced) return SampledSpectrum(0);
    }
    if (context_.scene.Occluded(LightContextAt(point), *sample)) return nothingFound();
    if (learner_) learner_->Found(query, *selected, sample->L * (cosine / sample->pdf));

    Float pLight = selected->pmf * sample->pdf;  // solid angle
    if (IsDelta(light.Kind())) return sample->L * f / (pLight * traced);
    Float pBsdf = bsdf.Pdf(point.wo, sample->wi);  // solid angle
    return sample->L * f * (PowerHeuristic(pLight, pBsdf) / (pLight * traced));
}

SampledSpectrum PathIntegrator::Li(CameraRay cameraRay, SampledWavelengths &lambda, Sampler &sampler,
                                   std::optional<VisibleSurface> *visible) const {
    const Scene &scene = context_.scene;
    PathRay path{cameraRay.ray, cameraRay.differential};
    const VisibleSurfaceReport report(context_, cameraRay, visible);
    SampledSpectrum L(0), beta(1);
    bool anyNonSpecular = false;
    Float etaScale = 1;
    int depth = 0;

    // The vertex the last scattering happened at, for the light-sampling density of what the ray hits. Set unless the
    // last scattering was specular or there was none: then light sampling could not have found it.
    bool lightCouldSample = false;
    LightSampleContext previous;
    LightQuery previousQuery;
    // Two places for the BSDF, so that the one of the previous vertex lives on for its query.
    std::array<Bsdf, 2> bsdfs;
    unsigned current = 0;
    Float pBsdf = 0;  // solid angle

    auto misWeight = [&](LightId id, const Point3 &p, const Normal3 &n) -> Float {
        if (!lightCouldSample) return settings_.sampledLightOnly ? Float(0) : Float(1);
        Float pmf = lights_->PMF(previousQuery, id);
        if (!(pmf > 0)) return 1;
        Float pLight = pmf * scene.Lights()[id].PdfLi(previous, path.ray.d, p, n, true);
        return PowerHeuristic(pBsdf, pLight);
    };

    while (true) {
        std::optional<SurfacePoint> hit = scene.Intersect(path.ray);
        if (!hit) {
            for (LightId id : scene.Lights().Infinite()) {
                SampledSpectrum Le = scene.Lights()[id].Le(path.ray.o, path.ray.d, lambda);
                if (Le) L += beta * Le * misWeight(id, Point3(0), Normal3(0));
            }
            break;
        }
        SurfacePoint &point = *hit;
        if (SampledSpectrum Le = EmittedRadiance(scene, point, lambda)) L += beta * Le * misWeight(point.light, point.p, point.n);

        FindFootprint(context_, point, path);
        Bsdf &bsdf = bsdfs[current];
        bsdf = ComputeBsdf(scene, point, lambda);
        if (!bsdf) {
            if (!settings_.seesThroughInterfaces) lightCouldSample = false;
            path.PassThrough(point);
            continue;
        }
        report.See(point, bsdf, path, lambda);
        if (settings_.regularize && anyNonSpecular) bsdf.Regularize();
        if (depth++ == settings_.maxDepth) break;
        ++ThreadCounters().pathVertices;

        LightQuery query = LightQueryAt(point, bsdf, lambda, depth);
        if (IsNonSpecular(bsdf.Flags())) L += beta * SampleDirect(point, bsdf, query, lambda, sampler);

        Float uComponent = sampler.Get1D();
        std::optional<BsdfSample> sample = bsdf.Sample(point.wo, uComponent, sampler.Get2D());
        if (!sample) break;
        beta *= sample->f * (AbsDot(sample->wi, point.shading.n) / sample->pdf);
        if (!beta) break;
        bool specular = IsSpecular(sample->flags);
        lightCouldSample = !specular;
        if (!specular) {
            pBsdf = sample->pdfIsProportional ? bsdf.Pdf(point.wo, sample->wi) : sample->pdf;
            previous = LightContextAt(point);
            previousQuery = query;
            current ^= 1;
            anyNonSpecular = true;
        }
        if (IsTransmissive(sample->flags)) etaScale *= Sqr(sample->eta);
        path.Scatter(point, *sample);

        if (settings_.subsurface && IsTransmissive(sample->flags)) {
            if (std::optional<Bssrdf> bssrdf = ComputeBssrdf(scene, point, lambda)) {
                // The way below the surface and the exit are part of the same scattering event, as in stock.
                std::optional<SubsurfaceExit> exit = SampleSubsurfaceExit(scene, point, *bssrdf, sampler);
                if (!exit) break;
                beta *= exit->weight;
                bsdfs[current] = exit->bsdf;
                LightQuery exitQuery = LightQueryAt(exit->point, bsdfs[current], lambda, depth);
                L += beta * SampleDirect(exit->point, bsdfs[current], exitQuery, lambda, sampler);
                Float uExit = sampler.Get1D();
                sample = exit->bsdf.Sample(exit->point.wo, uExit, sampler.Get2D());
                if (!sample) break;
                beta *= sample->f * (AbsDot(sample->wi, exit->point.shading.n) / sample->pdf);
                pBsdf = sample->pdf;
                previous = LightContextAt(exit->point);
                previousQuery = exitQuery;
                current ^= 1;
                lightCouldSample = anyNonSpecular = true;
                path.Scatter(exit->point, *sample);
            }
        }

        // Russian roulette on the throughput without the radiance scaling of refraction.
        Float survive = (beta * etaScale).MaxComponent();
        if (survive < 1 && depth > 1) {
            if (sampler.Get1D() >= survive) break;
            beta /= survive;
        }
    }
    ++ThreadCounters().cameraPaths;
    return L;
}

}  // namespace pbrt
