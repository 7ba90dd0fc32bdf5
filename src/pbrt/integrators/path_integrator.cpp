#include "pbrt/integrators/path_integrator.h"

#include "pbrt/core/counters.h"
#include "pbrt/integrators/bsdf_bounces.h"
#include "pbrt/integrators/guided_bounces.h"
#include "pbrt/integrators/vertex_selection.h"
#include "pbrt/math/warps.h"
#include "pbrt/paths/subsurface_exit.h"

namespace pbrt {

template <class Bounces>
SampledSpectrum PathIntegrator::SampleDirect(const PathVertex &vertex, const LightDistribution &lights,
                                             const Bounces &bounces, const SampledWavelengths &lambda, Sampler &sampler,
                                             LightLearner::PathPlaces &places) const {
    const auto &[point, bsdf] = vertex;
    // All random numbers are drawn in any case, so that dimensions stay aligned between samples.
    Float uSelect = sampler.Get1D();
    Point2 uLight = sampler.Get2D();
    std::optional<SampledLight> selected = lights.Sample(uSelect, &uLight);
    if (!selected) {
        ++ThreadCounters().zeroLightSamples;
        return SampledSpectrum(0);
    }
    auto found = [&](const SampledSpectrum &irradiance) {
        if (learner_) learner_->Found(places, lights.Query(), *selected, irradiance);
    };
    auto nothingFound = [&] {
        found(SampledSpectrum(0));
        return SampledSpectrum(0);
    };
    const LightPart light = context_.scene.Lights()[selected->light];
    std::optional<LightLiSample> sample =
        light.SampleLi(ScatteringContextAt(context_.scene, point, bsdf), uLight, lambda, true);
    if (!sample || !sample->L || !(sample->pdf > 0)) return nothingFound();

    const Float cosine = AbsDot(sample->wi, point.shading.n);
    SampledSpectrum f = bsdf.F(point.wo, sample->wi) * cosine;
    if (!f) return nothingFound();
    if (context_.scene.Occluded(LightContextAt(point), *sample)) return nothingFound();
    found(sample->L * (cosine / sample->pdf));

    Float pLight = selected->pmf * sample->pdf;  // solid angle
    if (IsDelta(light.Kind())) return sample->L * f / pLight;
    Float pBsdf = bounces.Pdf(vertex, sample->wi);  // solid angle
    return sample->L * f * (PowerHeuristic(pLight, pBsdf) / pLight);
}

SampledSpectrum PathIntegrator::Li(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler) const {
    if (!guide_) return Follow(start, lambda, sampler, BsdfBounces());
    return Follow(start, lambda, sampler, GuidedBounces(*guide_, start.pixel, start.sampleIndex));
}

template <class Bounces>
SampledSpectrum PathIntegrator::Follow(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler,
                                       Bounces &&bounces) const {
    const Scene &scene = context_.scene;
    PathWalk walk(context_, start.ray, start.visible);
    LightLearner::PathPlaces places;
    if (learner_) places = learner_->BeginPath(start.pixel, start.sampleIndex);
    SampledSpectrum L(0), beta(1);
    bool anyNonSpecular = false;
    Float etaScale = 1;
    int depth = 0;

    // `previous` is where the last scattering happened, for the light-sampling density of what the ray hits. It counts
    // unless that scattering was specular or there was none: then light sampling could not have found it.
    VertexSelection selections[2];
    VertexSelection *current = &selections[0], *previous = &selections[1];
    bool lightCouldSample = false;
    Float pBsdf = 0;  // solid angle
    auto scatteredFromCurrent = [&](Float pdf) {
        std::swap(current, previous);
        pBsdf = pdf;
        lightCouldSample = anyNonSpecular = true;
    };
    auto misWeight = [&](LightId id, const Point3 &p, const Normal3 &n) -> Float {
        if (!lightCouldSample) return settings_.sampledLightOnly ? Float(0) : Float(1);
        Float pmf = previous->lights.PMF(id);
        if (!(pmf > 0)) return 1;
        Float pLight = pmf * scene.Lights()[id].PdfLi(previous->from, walk.GetRay().d, p, n, true);
        return PowerHeuristic(pBsdf, pLight);
    };

    // Russian roulette. False: the path ends.
    auto survivesBy = [&](Float probability) {
        if (!(probability < 1)) return true;
        if (sampler.Get1D() >= probability) return false;
        beta /= probability;
        return true;
    };
    // On the throughput without the radiance scaling of refraction.
    auto survives = [&] { return survivesBy(std::max((beta * etaScale).MaxComponent(), settings_.minSurvival)); };

    for (;;) {
        const PathWalk::Met met = walk.Next();
        if (met == PathWalk::Met::TooManyInterfaces) break;
        walk.ForEachEmission(lambda, [&](const SampledSpectrum &Le, LightId id, const Point3 &p, const Normal3 &n) {
            // Beyond the scene there is one ray for the whole sky; light sampling would have chosen a part of it.
            const bool ofSky = met == PathWalk::Met::Nothing && lightCouldSample;
            const LightId part = ofSky ? previous->lights.PartTowards(id, previous->from.p, walk.GetRay().d) : id;
            L += beta * Le * misWeight(part, p, n);
        });
        if (met == PathWalk::Met::Nothing) break;
        if (!walk.FindScattering(lambda)) {
            if (!settings_.seesThroughInterfaces) lightCouldSample = false;
            continue;
        }
        if (settings_.regularize && anyNonSpecular) walk.Regularize();
        const auto &[point, bsdf] = walk.Vertex();
        bounces.Reached(walk.Vertex());
        if (depth++ == settings_.maxDepth) break;
        ++ThreadCounters().pathVertices;
        const bool samplesLight = IsNonSpecular(bsdf.Flags());
        if (bounces.KnowsRoulette() && depth > 1) {
            // Where nothing is known, and at specular surfaces, it is the throughput that counts. Light is sampled at
            // two vertices in any case.
            const Float survive = bounces.Survival(walk.Vertex(), beta.Average());
            if (depth > 2 && !(survive > 0 ? survivesBy(survive) : survives())) break;
        }
        bounces.Begin(walk.Vertex(), beta);

        if (samplesLight) {
            bounces.Open(walk.Vertex(), beta, L);
            current->Prepare(*lights_, walk.Vertex(), lambda, depth);
            L += beta * SampleDirect(walk.Vertex(), current->lights, bounces, lambda, sampler, places);
        }

        if (!survivesBy(bounces.SurvivalOnwards(beta.Average()))) break;
        bounces.GoesOn(beta, L);
        Float uComponent = sampler.Get1D();
        std::optional<BsdfSample> sample = bounces.Sample(walk.Vertex(), uComponent, sampler.Get2D());
        if (!sample) break;
        beta *= sample->f * (AbsDot(sample->wi, point.shading.n) / sample->pdf);
        if (!beta) break;
        if (IsSpecular(sample->flags)) {
            lightCouldSample = false;
        } else {
            scatteredFromCurrent(sample->pdfIsProportional ? bsdf.Pdf(point.wo, sample->wi) : sample->pdf);
            bounces.Left(walk.Vertex(), *sample, pBsdf, L, beta);
        }
        if (IsTransmissive(sample->flags)) etaScale *= Sqr(sample->eta);
        walk.Scatter(*sample);

        if (settings_.subsurface && IsTransmissive(sample->flags)) {
            if (std::optional<Bssrdf> bssrdf = ComputeBssrdf(scene, point, lambda)) {
                // The way below the surface and the exit are part of the same scattering event, as in stock.
                std::optional<SubsurfaceExit> exit = SampleSubsurfaceExit(scene, point, *bssrdf, sampler);
                if (!exit) break;
                beta *= exit->weight;
                walk.MoveTo(exit->vertex);
                bounces.Begin(walk.Vertex(), beta);
                current->Prepare(*lights_, walk.Vertex(), lambda, depth);
                L += beta * SampleDirect(walk.Vertex(), current->lights, bounces, lambda, sampler, places);
                Float uExit = sampler.Get1D();
                sample = bounces.Sample(walk.Vertex(), uExit, sampler.Get2D());
                if (!sample) break;
                beta *= sample->f * (AbsDot(sample->wi, point.shading.n) / sample->pdf);
                scatteredFromCurrent(sample->pdf);
                bounces.Left(walk.Vertex(), *sample, pBsdf, L, beta);
                walk.Scatter(*sample);
            }
        }

        if (!bounces.KnowsRoulette() && depth > 1 && !survives()) break;
    }
    bounces.End(L);
    ++ThreadCounters().cameraPaths;
    return L;
}

}  // namespace pbrt
