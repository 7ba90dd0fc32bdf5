#include "pbrt/integrators/volpath_integrator.h"

#include "pbrt/core/counters.h"
#include "pbrt/core/error.h"
#include "pbrt/integrators/bsdf_bounces.h"
#include "pbrt/integrators/guided_bounces.h"
#include "pbrt/integrators/vertex_selection.h"
#include "pbrt/paths/shadow_transmittance.h"
#include "pbrt/paths/subsurface_exit.h"

namespace pbrt {

namespace {

/// How a vertex scatters light from a direction: f times the cosine (or the phase function), and the density with which
/// scattering draws that direction (solid angle).
struct Scattering {
    SampledSpectrum f;
    Float pdf = 0;
};

}  // namespace

/// One camera path. `bounces` chooses directions at surfaces and knows their densities, and where paths should end.
template <class Bounces>
struct VolPathIntegrator::Path {
    const VolPathIntegrator &integrator;
    const Scene &scene;
    SampledWavelengths &lambda;
    Sampler &sampler;
    Bounces &bounces;
    PathWalk walk;
    LightLearner::PathPlaces places{};
    SampledSpectrum L{0};
    SpectralWeights weights{};
    VertexSelection selections[2];
    VertexSelection *current = &selections[0], *previous = &selections[1];
    int depth = 0;
    Float etaScale = 1;
    /// Whether light sampling at the vertex before could have found what the ray meets.
    bool lightCouldSample = false;
    bool anyNonSpecular = false;

    Path(const VolPathIntegrator &i, const PathStart &start, SampledWavelengths &l, Sampler &s, Bounces &b)
        : integrator(i),
          scene(i.context_.scene),
          lambda(l),
          sampler(s),
          bounces(b),
          walk(i.context_, start.ray, start.visible) {
        if (integrator.learner_) places = integrator.learner_->BeginPath(start.pixel, start.sampleIndex);
    }

    void Follow();
    /// False: the path ends. `scattered`: it goes on from inside the medium.
    bool PassMedium(bool *scattered);
    void AddEmission(PathWalk::Met met);
    bool ScatterAtSurface();
    bool PassBelowSurface();
    /// What the path's samples count: the throughput over the density, averaged over the wavelengths that could have
    /// drawn it.
    SampledSpectrum Weight() const { return weights.beta / weights.Mean(weights.ru); }
    /// Roulette by the throughput.
    bool SurvivesRoulette();
    bool Survives(Float probability);
    void PrepareSelection(const LightQuery &query, const LightSampleContext &from);
    void PrepareAtSurface();
    void LeftVertexBy(Float pdf);
    /// Light from one point on one light. `from`: the place that lights are sampled from.
    template <class Medium, class Scatter>
    void SampleDirect(const LightSampleContext &from, Medium &&mediumTowards, Scatter &&scatter);
    void SampleDirectAtSurface();
};

template <class Bounces>
void VolPathIntegrator::Path<Bounces>::PrepareSelection(const LightQuery &query, const LightSampleContext &from) {
    current->Prepare(*integrator.lights_, query, from);
}

template <class Bounces>
void VolPathIntegrator::Path<Bounces>::PrepareAtSurface() {
    PrepareSelection(LightQueryAt(walk.Vertex(), lambda, depth), LightContextAt(walk.Vertex().point));
}

template <class Bounces>
void VolPathIntegrator::Path<Bounces>::LeftVertexBy(Float pdf) {
    weights.SampledDirection(pdf);
    std::swap(current, previous);
    lightCouldSample = anyNonSpecular = true;
}

template <class Bounces>
template <class Medium, class Scatter>
void VolPathIntegrator::Path<Bounces>::SampleDirect(const LightSampleContext &from, Medium &&mediumTowards,
                                                    Scatter &&scatter) {
    // All random numbers are drawn in any case, so that dimensions stay aligned between samples.
    const Float uSelect = sampler.Get1D();
    Point2 uLight = sampler.Get2D();
    const LightDistribution &lights = current->lights;
    const std::optional<SampledLight> selected = lights.Sample(uSelect, &uLight);
    if (!selected) {
        ++ThreadCounters().zeroLightSamples;
        return;
    }
    LightLearner *learner = integrator.learner_;
    auto found = [&](const SampledSpectrum &irradiance) {
        if (learner) learner->Found(places, lights.Query(), *selected, irradiance);
    };
    const LightPart light = scene.Lights()[selected->light];
    const std::optional<LightLiSample> sample = light.SampleLi(from, uLight, lambda, true);
    if (!sample || !sample->L || !(sample->pdf > 0)) return found(SampledSpectrum(0));
    const Scattering to = scatter(sample->wi);
    if (!to.f) return found(SampledSpectrum(0));
    Rng rng(Hash(current->from.p, sample->wi, uLight));
    const ShadowTransmittance through =
        TraceShadow(scene, current->from, mediumTowards(sample->wi), *sample, lambda, rng);
    const Float cosine = current->from.ns == Normal3(0) ? 1 : AbsDot(sample->wi, current->from.ns);
    found(sample->L * through.value * (cosine / (sample->pdf * weights.Mean(through.rl))));
    if (!through.value) return;

    const Float pLight = selected->pmf * sample->pdf;  // solid angle
    SampledSpectrum densities = weights.ru * through.rl * pLight;
    if (!IsDelta(light.Kind())) densities += weights.ru * through.ru * to.pdf;
    L += weights.beta * to.f * sample->L * through.value / weights.Mean(densities);
}

template <class Bounces>
void VolPathIntegrator::Path<Bounces>::SampleDirectAtSurface() {
    const auto &[point, bsdf] = walk.Vertex();
    SampleDirect(
        ScatteringContextAt(scene, point, bsdf), [&](const Vector3 &wi) { return point.MediumTowards(wi); },
        [&](const Vector3 &wi) {
            const SampledSpectrum f = bsdf.F(point.wo, wi) * AbsDot(wi, point.shading.n);
            return Scattering{f, f ? bounces.Pdf(walk.Vertex(), wi) : 0};
        });
}

template <class Bounces>
bool VolPathIntegrator::Path<Bounces>::PassMedium(bool *scattered) {
    const Medium *medium = walk.MediumAhead();
    if (!medium) return true;
    const Float u = sampler.Get1D();
    Rng rng = NumbersAlong(walk.GetRay(), u);
    // Emission between the last vertices that a path may have is left out, as in stock pbrt-v4.
    const bool emits = depth < integrator.settings_.maxDepth && !integrator.settings_.sampledLightOnly;
    const MediumEvent event = walk.ThroughMedium(lambda, u, rng, emits, weights,
                                                 [&](const SampledSpectrum &radiance, Float) { L += radiance; });
    if (event.kind == MediumEvent::Kind::Absorbed || !weights.beta) return false;
    if (event.kind == MediumEvent::Kind::Passed) return true;
    if (depth++ == integrator.settings_.maxDepth) return false;
    ++ThreadCounters().pathVertices;

    const Ray &ray = walk.GetRay();
    const Point3 p = ray(event.t);
    const Vector3 wo = -ray.d;
    const HenyeyGreenstein &phase = medium->Phase();
    bounces.ReachedInMedium(p);
    if (bounces.KnowsRoulette() && depth > 1) {
        const Float survive = bounces.SurvivalInMedium(p, Weight().Average());
        if (survive > 0 && !Survives(survive)) return false;
    }
    bounces.OpenInMedium(p, Weight(), L);
    PrepareSelection(LightQueryInMedium(p, wo, ray.medium, phase, ray.time, lambda, depth), {p, {}, {}, {}, ray.time});
    SampleDirect(
        current->from, [&](const Vector3 &) { return ray.medium; },
        [&](const Vector3 &wi) {
            const Float value = phase.P(wo, wi);
            return Scattering{SampledSpectrum(value), value};
        });
    if (!Survives(bounces.SurvivalOnwards(Weight().Average()))) return false;
    bounces.GoesOn(Weight(), L);
    const HenyeyGreenstein::Sample sample = phase.SampleP(wo, sampler.Get2D());
    if (!(sample.p > 0)) return false;
    LeftVertexBy(sample.p);
    walk.ScatterInMedium(p, sample.wi);
    *scattered = true;
    return true;
}

template <class Bounces>
void VolPathIntegrator::Path<Bounces>::AddEmission(PathWalk::Met met) {
    walk.ForEachEmission(lambda, [&](const SampledSpectrum &Le, LightId id, const Point3 &p, const Normal3 &n) {
        SampledSpectrum densities = weights.ru;
        if (lightCouldSample) {
            const Vector3 &d = walk.GetRay().d;
            const LightId part =
                met == PathWalk::Met::Nothing ? previous->lights.PartTowards(id, previous->from.p, d) : id;
            if (const Float pmf = previous->lights.PMF(part); pmf > 0)
                densities += weights.rl * (pmf * scene.Lights()[part].PdfLi(previous->from, d, p, n, true));
        } else if (integrator.settings_.sampledLightOnly) {
            return;
        }
        L += weights.beta * Le / weights.Mean(densities);
    });
}

template <class Bounces>
bool VolPathIntegrator::Path<Bounces>::PassBelowSurface() {
    const SurfacePoint &point = walk.Vertex().point;
    const std::optional<Bssrdf> bssrdf = ComputeBssrdf(scene, point, lambda);
    if (!bssrdf) return true;
    // The way below the surface and the exit are part of the same scattering event, as in stock.
    const std::optional<SubsurfaceExit> exit = SampleSubsurfaceExit(scene, point, *bssrdf, sampler);
    if (!exit) return false;
    weights.beta *= exit->weight;
    walk.MoveTo(exit->vertex);
    bounces.Begin(walk.Vertex(), Weight());
    PrepareAtSurface();
    SampleDirectAtSurface();
    const Float uExit = sampler.Get1D();
    const std::optional<BsdfSample> sample = bounces.Sample(walk.Vertex(), uExit, sampler.Get2D());
    if (!sample) return false;
    weights.beta *= sample->f * (AbsDot(sample->wi, walk.Vertex().point.shading.n) / sample->pdf);
    LeftVertexBy(sample->pdf);
    bounces.Left(walk.Vertex(), *sample, sample->pdf, L, Weight());
    walk.Scatter(*sample);
    return true;
}

template <class Bounces>
bool VolPathIntegrator::Path<Bounces>::ScatterAtSurface() {
    if (integrator.settings_.regularize && anyNonSpecular) walk.Regularize();
    const auto &[point, bsdf] = walk.Vertex();
    bounces.Reached(walk.Vertex());
    if (depth++ == integrator.settings_.maxDepth) return false;
    ++ThreadCounters().pathVertices;
    const bool samplesLight = IsNonSpecular(bsdf.Flags());
    if (bounces.KnowsRoulette() && depth > 1) {
        // Where nothing is known, and at specular surfaces, it is the throughput that counts. Light is sampled at two
        // vertices in any case.
        const Float survive = bounces.Survival(walk.Vertex(), Weight().Average());
        if (depth > 2 && !(survive > 0 ? Survives(survive) : SurvivesRoulette())) return false;
    }
    bounces.Begin(walk.Vertex(), Weight());
    if (samplesLight) {
        bounces.Open(walk.Vertex(), Weight(), L);
        PrepareAtSurface();
        SampleDirectAtSurface();
    }
    if (!Survives(bounces.SurvivalOnwards(Weight().Average()))) return false;
    bounces.GoesOn(Weight(), L);
    const Float uComponent = sampler.Get1D();
    const std::optional<BsdfSample> sample = bounces.Sample(walk.Vertex(), uComponent, sampler.Get2D());
    if (!sample) return false;
    weights.beta *= sample->f * (AbsDot(sample->wi, point.shading.n) / sample->pdf);
    if (!weights.beta) return false;
    if (IsSpecular(sample->flags)) {
        lightCouldSample = false;
    } else {
        const Float pdf = sample->pdfIsProportional ? bsdf.Pdf(point.wo, sample->wi) : sample->pdf;
        LeftVertexBy(pdf);
        bounces.Left(walk.Vertex(), *sample, pdf, L, Weight());
    }
    if (IsTransmissive(sample->flags)) etaScale *= Sqr(sample->eta);
    walk.Scatter(*sample);
    const bool entersBelow = integrator.settings_.subsurface && IsTransmissive(sample->flags);
    if (entersBelow && !PassBelowSurface()) return false;
    return bounces.KnowsRoulette() || depth <= 1 || SurvivesRoulette();
}

template <class Bounces>
bool VolPathIntegrator::Path<Bounces>::SurvivesRoulette() {
    // The throughput without the radiance scaling of refraction.
    return Survives(std::max((weights.beta * etaScale / weights.Mean(weights.ru)).MaxComponent(),
                             integrator.settings_.minSurvival));
}

template <class Bounces>
bool VolPathIntegrator::Path<Bounces>::Survives(Float probability) {
    if (!(probability < 1)) return true;
    if (sampler.Get1D() >= probability) return false;
    weights.beta /= probability;
    return true;
}

template <class Bounces>
void VolPathIntegrator::Path<Bounces>::Follow() {
    for (;;) {
        const PathWalk::Met met = walk.Next();
        if (met == PathWalk::Met::TooManyInterfaces) return;
        bool scattered = false;
        if (!PassMedium(&scattered)) return;
        if (scattered) continue;
        AddEmission(met);
        if (met == PathWalk::Met::Nothing) return;
        const bool scatters = walk.FindScattering(lambda);
        weights.onlyFirst = lambda.SecondaryTerminated();
        if (!scatters) continue;
        if (!ScatterAtSurface()) return;
    }
}

SampledSpectrum VolPathIntegrator::Li(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler) const {
    const auto follow = [&](auto &&bounces) {
        Path path(*this, start, lambda, sampler, bounces);
        path.Follow();
        bounces.End(path.L);
        ++ThreadCounters().cameraPaths;
        return path.L;
    };
    if (!guide_) return follow(BsdfBounces());
    return follow(GuidedBounces(*guide_, start.pixel, start.sampleIndex));
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

}  // namespace pbrt
