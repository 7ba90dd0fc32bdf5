#include "pbrt/integrators/bdpt_integrator.h"

#include "pbrt/core/counters.h"
#include "pbrt/core/parallel.h"
#include "pbrt/integrators/filtered_splat.h"
#include "pbrt/lightsamplers/simple_light_samplers.h"
#include "pbrt/paths/adjoint_cosine.h"

namespace pbrt {

/// One sample of a pixel.
struct BdptIntegrator::Sample {
    const PathStart &start;
    SampledWavelengths &lambda;
    const Samplers &samplers;
    Subpaths &paths;
    Float time = 0, pixels = 1;
    LightLearner::PathPlaces places{};
};

BdptIntegrator::BdptIntegrator(const PathContext &context, int maxDepth, bool regularize,
                               std::unique_ptr<LightSampler> connecting, std::unique_ptr<ShadowRayGate> gate,
                               std::unique_ptr<LightSampler> shooting)
    : context_(context),
      maxDepth_(maxDepth),
      regularize_(regularize),
      shooting_(ByPowerUnless(std::move(shooting), context.scene.Lights())),
      connecting_(std::move(connecting)),
      gate_(std::move(gate)),
      learner_(connecting_ ? connecting_->Learner() : nullptr),
      weights_(context.scene.Lights(), *shooting_, connecting_ ? *connecting_ : *shooting_),
      subpaths_(static_cast<size_t>(ThreadCount())) {
    for (Subpaths &s : subpaths_) {
        const auto surfaces = static_cast<size_t>(std::min(maxDepth, kMaxSubpath));
        s.light.resize(surfaces + 1);
        s.camera.resize(surfaces + 1);
        s.path.resize(2 * surfaces + 4);
    }
}

void BdptIntegrator::Prepare(PrepareContext &prepare) {
    if (connecting_) connecting_->Prepare(prepare);
    if (gate_) gate_->Prepare(prepare);
    shooting_->Prepare(prepare);
}

template <class Emitted>
void BdptIntegrator::Follow(PathWalk &walk, std::span<BdptVertex> vertices, int *count, Float pdf, TransportMode mode,
                            Sampler &sampler, Sample &sample, Emitted &&emitted) const {
    SampledSpectrum beta = vertices[0].beta;
    bool anyNonSpecular = false;
    for (;;) {
        BdptVertex &before = vertices[static_cast<size_t>(*count - 1)];
        const PathWalk::Met met = walk.Next();
        if (met == PathWalk::Met::TooManyInterfaces) return;
        emitted(walk, beta, pdf);
        if (met == PathWalk::Met::Nothing || *count == static_cast<int>(vertices.size())) return;
        if (!walk.FindScattering(sample.lambda)) continue;
        ++ThreadCounters().pathVertices;
        if (regularize_ && anyNonSpecular) walk.Regularize();
        BdptVertex &vertex = vertices[static_cast<size_t>((*count)++)];
        vertex.kind = BdptVertex::Kind::Surface;
        vertex.isBeyondScene = vertex.isSpecular = false;
        vertex.beta = beta;
        vertex.surface = walk.Vertex();
        vertex.pdfReverse = 0;
        const auto &[point, bsdf] = vertex.surface;
        vertex.pdfForward = before.isBeyondScene ? pdf * AbsDot(point.n, point.wo) : vertex.AreaPdf(before, pdf);
        const Float uComponent = sampler.Get1D();
        const std::optional<BsdfSample> next = bsdf.Sample(point.wo, uComponent, sampler.Get2D(), mode);
        if (!next) return;
        beta *= next->f * ((mode == TransportMode::Radiance ? AbsDot(next->wi, point.shading.n)
                                                            : AdjointCosine(point, point.wo, next->wi)) /
                           next->pdf);
        if (!beta) return;
        vertex.isSpecular = IsSpecular(next->flags);
        if (vertex.isSpecular) {
            pdf = 0;
        } else {
            anyNonSpecular = true;
            pdf = next->pdfIsProportional ? bsdf.Pdf(point.wo, next->wi, mode) : next->pdf;
            const TransportMode other =
                mode == TransportMode::Radiance ? TransportMode::Importance : TransportMode::Radiance;
            before.pdfReverse = before.AreaPdf(vertex, bsdf.Pdf(next->wi, point.wo, other));
        }
        walk.Scatter(*next);
    }
}

void BdptIntegrator::TraceLight(Sample &sample) const {
    const Scene &scene = context_.scene;
    Subpaths &paths = sample.paths;
    Sampler &sampler = sample.samplers.light;
    paths.lightCount = 0;
    LightQuery anywhere;
    anywhere.time = sample.time;
    const std::optional<SampledLight> chosen = shooting_->Sample(anywhere, sampler.Get1D());
    const Point2 uPosition = sampler.Get2D(), uDirection = sampler.Get2D();
    if (!chosen || !(chosen->pmf > 0) || maxDepth_ == 0) return;
    const LightPart light = scene.Lights()[chosen->light];
    const std::optional<LightLeSample> left = light.SampleLe(uPosition, uDirection, sample.lambda);
    if (!left) return;
    BdptVertex &first = paths.light[0];
    first.kind = BdptVertex::Kind::Light;
    first.isSpecular = false;
    first.light = chosen->light;
    first.isBeyondScene = light.Kind() == LightKind::Infinite || light.Kind() == LightKind::DeltaDirection;
    first.n = left->n;
    first.p = left->n == Normal3(0) ? left->ray.o : left->p;
    first.pError = left->pError;
    first.direction = left->ray.d;
    first.pdfForward = chosen->pmf * (first.isBeyondScene ? left->pdfDirection : left->pdfPosition);
    first.pdfReverse = 0;
    const Float cosine = left->n == Normal3(0) ? 1 : AbsDot(left->n, left->ray.d);
    first.beta = left->L * (cosine / (chosen->pmf * left->pdfPosition * left->pdfDirection));
    Ray ray = left->ray;
    ray.time = sample.time;
    ray.medium = scene.MediumOfLight(chosen->light);
    PathWalk walk(context_, ray);
    paths.lightCount = 1;
    Follow(walk, paths.light, &paths.lightCount, first.isBeyondScene ? left->pdfPosition : left->pdfDirection,
           TransportMode::Importance, sampler, sample, [](const PathWalk &, const SampledSpectrum &, Float) {});
}

SampledSpectrum BdptIntegrator::TraceCamera(Sample &sample) const {
    Subpaths &paths = sample.paths;
    BdptVertex &first = paths.camera[0];
    first.kind = BdptVertex::Kind::Camera;
    first.isSpecular = false;
    const Ray &ray = sample.start.ray.ray;
    first.p = ray.o;
    first.n = Normal3(0);
    first.direction = ray.d;
    // The density of camera rays, by solid angle or, of a parallel view, by area across them, is the importance that a
    // place at the distance 1 has for the pixels, divided by their number.
    const std::optional<CameraConnection> seen = context_.camera.Connect(ray(1), sample.start.pLens, sample.time);
    first.isBeyondScene = seen && seen->isParallel;
    const Float pdf = seen ? seen->weight / sample.pixels : 0;
    first.beta = SampledSpectrum(1);
    paths.cameraCount = 1;
    SampledSpectrum L(0);
    PathWalk walk(context_, sample.start.ray, sample.start.visible);
    Follow(walk, paths.camera, &paths.cameraCount, pdf, TransportMode::Radiance, sample.samplers.camera, sample,
           [&](const PathWalk &w, const SampledSpectrum &beta, Float pdfOfRay) {
               w.ForEachEmission(sample.lambda,
                                 [&](const SampledSpectrum &Le, LightId id, const Point3 &p, const Normal3 &n) {
                                     BdptVertex light;
                                     light.kind = BdptVertex::Kind::Light;
                                     light.light = id;
                                     light.p = p;
                                     light.n = n;
                                     light.isBeyondScene = n == Normal3(0);
                                     light.direction = -w.GetRay().d;
                                     const BdptVertex &last = paths.camera[static_cast<size_t>(paths.cameraCount - 1)];
                                     light.pdfForward = light.AreaPdf(last, pdfOfRay);
                                     L += beta * Le * WeightOf(sample, 0, paths.cameraCount, &light, 0);
                                 });
           });
    return L;
}

Float BdptIntegrator::WeightOf(Sample &sample, int lightVertices, int cameraVertices, const BdptVertex *end,
                               Float cameraPdf) const {
    const Subpaths &paths = sample.paths;
    size_t n = 0;
    auto &path = sample.paths.path;
    if (end) path[n++] = end;
    for (int i = end && lightVertices > 0 ? 1 : 0; i < lightVertices; ++i)
        path[n++] = &paths.light[static_cast<size_t>(i)];
    for (int i = cameraVertices - 1; i >= 0; --i) path[n++] = &paths.camera[static_cast<size_t>(i)];
    return weights_.Weight({path.data(), n}, lightVertices, cameraPdf, sample.lambda);
}

SampledSpectrum BdptIntegrator::ConnectToLight(Sample &sample, int cameraVertices) const {
    const Scene &scene = context_.scene;
    const BdptVertex &last = sample.paths.camera[static_cast<size_t>(cameraVertices - 1)];
    const auto &[point, bsdf] = last.surface;
    const LightQuery query = BdptQuery(last, sample.paths.camera[static_cast<size_t>(cameraVertices - 2)],
                                       sample.lambda, cameraVertices - 1);
    Sampler &sampler = sample.samplers.connections;
    Point2 u = sampler.Get2D();
    LightMemory memory;
    const LightDistribution lights = (connecting_ ? *connecting_ : *shooting_).At(query, memory);
    const std::optional<SampledLight> chosen = lights.Sample(sampler.Get1D(), &u);
    const Float uGate = gate_ ? sampler.Get1D() : 0;
    if (!chosen || !(chosen->pmf > 0)) return SampledSpectrum(0);
    const auto learn = [&](const SampledSpectrum &irradiance) {
        if (learner_) learner_->Found(sample.places, query, *chosen, irradiance);
    };
    const LightPart light = scene.Lights()[chosen->light];
    const auto found = light.SampleLi(ScatteringContextAt(scene, point, bsdf), u, sample.lambda, false);
    SampledSpectrum L(0);
    if (found && found->L && found->pdf > 0)
        L = last.beta * bsdf.F(point.wo, found->wi) * found->L *
            (AbsDot(found->wi, point.shading.n) / (chosen->pmf * found->pdf));
    if (!L) {
        learn(SampledSpectrum(0));
        return L;
    }
    Float traced = 1;
    if (gate_) {
        traced = gate_->TraceProbability(query, chosen->light, found->pLight);
        if (uGate >= traced) return SampledSpectrum(0);
    }
    const bool isBlocked = scene.Occluded(LightContextAt(point), *found);
    if (learner_ && light.Kind() == LightKind::Infinite) learner_->Looked(query, found->wi, !isBlocked);
    learn(isBlocked ? SampledSpectrum(0) : found->L * (AbsDot(found->wi, point.shading.n) / found->pdf));
    if (isBlocked) return SampledSpectrum(0);
    BdptVertex end;
    end.kind = BdptVertex::Kind::Light;
    const LightTable &table = scene.Lights();
    end.light = table.IsTile(chosen->light) ? table.SkyOf(chosen->light) : chosen->light;
    end.p = found->pLight;
    end.n = found->nLight;
    end.isBeyondScene = light.Kind() == LightKind::Infinite || light.Kind() == LightKind::DeltaDirection;
    end.direction = -found->wi;
    end.pdfForward = weights_.LightPdf(end, last);
    return L * (WeightOf(sample, 1, cameraVertices, &end, 0) / traced);
}

SampledSpectrum BdptIntegrator::ConnectSubpaths(Sample &sample, int lightVertices, int cameraVertices) const {
    const BdptVertex &a = sample.paths.light[static_cast<size_t>(lightVertices - 1)],
                     &b = sample.paths.camera[static_cast<size_t>(cameraVertices - 1)];
    const Vector3 d = b.surface.point.p - a.surface.point.p;
    const Float l2 = LengthSquared(d);
    if (!(l2 > 0)) return SampledSpectrum(0);
    const Vector3 w = d / std::sqrt(l2);
    const SurfacePoint &from = a.surface.point, &to = b.surface.point;
    const SampledSpectrum L = a.beta * a.surface.bsdf.F(from.wo, w, TransportMode::Importance) *
                              (AdjointCosine(from, from.wo, w) / l2) * b.surface.bsdf.F(to.wo, -w) *
                              AbsDot(w, to.shading.n) * b.beta;
    if (!L) return L;
    LightLiSample end;
    end.wi = -w;
    end.pLight = from.p;
    end.pLightError = from.pError;
    end.nLight = from.n;
    if (context_.scene.Occluded(LightContextAt(to), end)) return SampledSpectrum(0);
    return L * WeightOf(sample, lightVertices, cameraVertices, nullptr, 0);
}

void BdptIntegrator::ConnectToCamera(Sample &sample, int lightVertices, std::vector<SeenLight> &seenLight) const {
    const Point2 uLens = sample.samplers.connections.Get2D();
    const BdptVertex &last = sample.paths.light[static_cast<size_t>(lightVertices - 1)];
    if (!IsNonSpecular(last.surface.bsdf.Flags())) return;
    const SurfacePoint &point = last.surface.point;
    const std::optional<CameraConnection> seen = context_.camera.Connect(point.p, uLens, sample.time);
    if (!seen) return;
    const SampledSpectrum L = last.beta * last.surface.bsdf.F(point.wo, seen->wi, TransportMode::Importance) *
                              (AdjointCosine(point, point.wo, seen->wi) * seen->weight);
    if (!L) return;
    LightLiSample lens;
    lens.wi = seen->wi;
    lens.pLight = seen->p;
    if (context_.scene.Occluded(LightContextAt(point), lens)) return;
    // These connections come last: the camera's vertex of the camera path is not needed any more.
    BdptVertex &camera = sample.paths.camera[0];
    camera.p = seen->p;
    camera.direction = -seen->wi;
    camera.isBeyondScene = seen->isParallel;
    const Float cameraPdf = seen->weight * AbsDot(point.n, seen->wi) / sample.pixels;
    const Float weight = WeightOf(sample, lightVertices, 1, nullptr, cameraPdf);
    seenLight.push_back({seen->pFilm, L * weight});
}

SampledSpectrum BdptIntegrator::TracePair(const PathStart &start, SampledWavelengths &lambda, const Samplers &samplers,
                                          Float pixels, std::vector<SeenLight> &seen) const {
    ++ThreadCounters().cameraPaths;
    Subpaths &paths = subpaths_[static_cast<size_t>(ThreadIndex())];
    Sample sample{start, lambda, samplers, paths, start.ray.ray.time, pixels};
    if (learner_) sample.places = learner_->BeginPath(start.pixel, start.sampleIndex);
    TraceLight(sample);
    SampledSpectrum L = TraceCamera(sample);
    for (int t = 2; t <= paths.cameraCount; ++t) {
        if (!IsNonSpecular(paths.camera[static_cast<size_t>(t - 1)].surface.bsdf.Flags())) continue;
        L += ConnectToLight(sample, t);
        for (int s = 2; s <= paths.lightCount && s + t - 2 <= maxDepth_; ++s)
            if (IsNonSpecular(paths.light[static_cast<size_t>(s - 1)].surface.bsdf.Flags()))
                L += ConnectSubpaths(sample, s, t);
    }
    for (int s = 2; s <= paths.lightCount; ++s) ConnectToCamera(sample, s, seen);
    return L;
}

SampledSpectrum BdptIntegrator::Li(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler) const {
    const RenderPass &pass = *start.pass;
    std::vector<SeenLight> &seen = subpaths_[static_cast<size_t>(ThreadIndex())].seen;
    seen.clear();
    const SampledSpectrum L =
        TracePair(start, lambda, {sampler, sampler, sampler}, static_cast<Float>(pass.film.PixelBounds().Area()), seen);
    if (pass.keepsSamples)
        for (const SeenLight &s : seen) AddFilteredSplat(pass.film, pass.filter, s.pFilm, s.L, lambda);
    return L;
}

}  // namespace pbrt
