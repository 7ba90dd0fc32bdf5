#include "pbrt/integrators/bdpt_integrator.h"

#include "pbrt/core/parallel.h"
#include "pbrt/lightsamplers/simple_light_samplers.h"
#include "pbrt/transport/direct_light.h"

namespace pbrt {

struct BdptIntegrator::Sample {
    const PathStart &start;
    SampledWavelengths &lambda;
    const Samplers &samplers;
    Subpaths &paths;
    Float time = 0, pixels = 1, splatUnit = 1;
    ObservedPath observed{};
};

BdptIntegrator::BdptIntegrator(const PathContext &context, int maxDepth, bool regularize,
                               std::unique_ptr<LightSampler> connecting, std::unique_ptr<LightSampler> shooting,
                               std::unique_ptr<StrategyImages> strategies)
    : context_(context), maxDepth_(maxDepth), regularize_(regularize),
      shooting_(ByPowerUnless(std::move(shooting), context.scene.Lights())), connecting_(std::move(connecting)),
      hasMedia_(context.scene.HasMedia()), observer_(connecting_ ? connecting_->Observer() : nullptr),
      weights_(context.scene.Lights(), *shooting_, connecting_ ? *connecting_ : *shooting_),
      strategies_(std::move(strategies)), subpaths_(size_t(ThreadCount())) {
    for (Subpaths &s : subpaths_) {
        const auto surfaces = size_t(std::min(maxDepth, kMaxSubpath));
        s.light.resize(surfaces + 1);
        s.camera.resize(surfaces + 1);
        s.path.resize(2 * surfaces + 4);
    }
}

struct BdptIntegrator::Subpath {
    std::span<BdptVertex> vertices;
    int &count;
    TransportMode mode;
    Sampler &sampler;
    Float pdf;  ///< of the next ray: solid angle, or outside the scene area across it
    SpectralWeights weights{};
    SampledSpectrum L{0};  ///< emission hit on the way
    Float ofFirst = 0;     ///< the same at the first wavelength, as if it had been the only one throughout
    bool anyNonSpecular = false;

    BdptVertex &Last() const { return vertices[count - 1]; }
    BdptVertex &Append(BdptVertex::Kind kind) const {
        BdptVertex &vertex = vertices[count++];
        vertex.kind = kind;
        vertex.isBeyondScene = vertex.isSpecular = false;
        vertex.beta = weights.beta;
        vertex.ru = weights.ru;
        vertex.pdfReverse = 0;
        ++ThreadCounters().pathVertices;
        return vertex;
    }
};

bool BdptIntegrator::PassMedium(PathWalk &walk, Subpath &path, const Sample &sample, bool *scattered) const {
    const Medium *medium = walk.MediumAhead();
    if (!medium) return true;
    const Ray &ray = walk.GetRay();
    // As in volpath, the last ray of a path reaches lights but not medium emission.
    const bool emits = path.mode == TransportMode::Radiance && path.count <= maxDepth_;
    path.weights.onlyFirst = sample.lambda.SecondaryTerminated();
    const MediumEvent event = walk.ThroughMedium(
        sample.lambda, path.sampler, emits, path.weights, [&](const SampledSpectrum &radiance, Float mean) {
            path.L += radiance;
            path.ofFirst += radiance[0] * mean;
            if (strategies_) sample.paths.contributions.push_back({0, path.count + 1, radiance, radiance, {}, mean});
        });
    if (event.kind == MediumEvent::Kind::Absorbed || !path.weights.beta) return false;
    if (event.kind == MediumEvent::Kind::Passed) return true;
    if (path.count == int(path.vertices.size())) return false;
    BdptVertex &before = path.Last(), &vertex = path.Append(BdptVertex::Kind::Medium);
    vertex.p = ray(event.t);
    vertex.n = Normal3(0);
    vertex.direction = -ray.d;
    vertex.medium = ray.medium;
    vertex.phase = &medium->Phase();
    vertex.time = ray.time;
    vertex.pdfForward = before.isBeyondScene ? path.pdf : vertex.AreaPdf(before, path.pdf);
    const HenyeyGreenstein::Sample next = medium->Phase().SampleP(vertex.direction, path.sampler.Get2D());
    if (!(next.p > 0)) return false;
    path.pdf = next.p;
    path.anyNonSpecular = true;
    before.pdfReverse = before.AreaPdf(vertex, next.p);
    walk.ScatterInMedium(vertex.p, next.wi);
    *scattered = true;
    return true;
}

bool BdptIntegrator::ScatterAtSurface(PathWalk &walk, Subpath &path) const {
    if (regularize_ && path.anyNonSpecular) walk.Regularize();
    const TransportMode mode = path.mode;
    BdptVertex &before = path.Last(), &vertex = path.Append(BdptVertex::Kind::Surface);
    vertex.surface = walk.Vertex();
    const auto &[point, bsdf] = vertex.surface;
    vertex.pdfForward =
        before.isBeyondScene ? vertex.AreaPdfOfParallel(path.pdf, point.wo) : vertex.AreaPdf(before, path.pdf);
    const Float uComponent = path.sampler.Get1D();
    const std::optional<BsdfSample> next = bsdf.Sample(point.wo, uComponent, path.sampler.Get2D(), mode);
    if (!next) return false;
    path.weights.beta *= next->f * ((mode == TransportMode::Radiance ? AbsDot(next->wi, point.shading.n)
                                                                     : AdjointCosine(point, point.wo, next->wi)) /
                                    next->pdf);
    if (!path.weights.beta) return false;
    vertex.isSpecular = IsSpecular(next->flags);
    if (vertex.isSpecular) {
        path.pdf = 0;
    } else {
        path.anyNonSpecular = true;
        path.pdf = next->pdfIsProportional ? bsdf.Pdf(point.wo, next->wi, mode) : next->pdf;
        const TransportMode other =
            mode == TransportMode::Radiance ? TransportMode::Importance : TransportMode::Radiance;
        before.pdfReverse = before.AreaPdf(vertex, bsdf.Pdf(next->wi, point.wo, other));
    }
    walk.Scatter(*next);
    return true;
}

void BdptIntegrator::Follow(PathWalk &walk, Subpath &path, Sample &sample) const {
    path.weights.beta = path.vertices[0].beta;
    for (;;) {
        const PathWalk::Met met = walk.Next();
        if (met == PathWalk::Met::TooManyInterfaces) return;
        if (hasMedia_) {
            bool scattered = false;
            if (!PassMedium(walk, path, sample, &scattered)) return;
            if (scattered) continue;
        }
        if (path.mode == TransportMode::Radiance) AddEmission(walk, path, sample);
        if (met == PathWalk::Met::Nothing) return;
        // A ray from the last vertex continues through non-scattering surfaces, as there may be light behind them.
        const bool isFull = path.count == int(path.vertices.size());
        if (isFull && (path.mode == TransportMode::Importance || ScattersSurely(context_.scene, walk.Vertex().point)))
            return;
        if (walk.FindScattering(sample.lambda, path.weights) && (isFull || !ScatterAtSurface(walk, path))) return;
    }
}

void BdptIntegrator::TraceLight(Sample &sample) const {
    const Scene &scene = context_.scene;
    Subpaths &paths = sample.paths;
    Sampler &sampler = sample.samplers.light;
    paths.lightCount = 0;
    const std::optional<SampledLight> chosen = shooting_->Sample({.time = sample.time}, sampler.Get1D());
    const Point2 uPosition = sampler.Get2D(), uDirection = sampler.Get2D();
    if (!chosen || !(chosen->pmf > 0) || maxDepth_ == 0) return;
    const LightComponent light = scene.Lights()[chosen->light];
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
    ray.medium = scene.MediumOfLight(chosen->light, left->n, left->ray.d);
    PathWalk walk(context_, ray);
    paths.lightCount = 1;
    Subpath subpath{paths.light, paths.lightCount, TransportMode::Importance, sampler,
                    first.isBeyondScene ? left->pdfPosition : left->pdfDirection};
    Follow(walk, subpath, sample);
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
    first.isBeyondScene = context_.camera.IsParallel();
    const Float pdf = context_.camera.RayWeight(ray.d, sample.time) / sample.pixels;
    first.beta = SampledSpectrum(1);
    paths.cameraCount = 1;
    PathWalk walk(context_, sample.start.ray, sample.start.visible);
    Subpath subpath{paths.camera, paths.cameraCount, TransportMode::Radiance, sample.samplers.camera, pdf};
    Follow(walk, subpath, sample);
    // Contributions before termination of the secondary wavelengths count on the first one only.
    if (!hasMedia_ || !sample.lambda.SecondaryTerminated()) return subpath.L;
    for (StrategyImages::Contribution &f : paths.contributions) {
        f.weighted *= f.mean;
        f.unweighted *= f.mean;
    }
    return SampledSpectrum(subpath.ofFirst);
}

void BdptIntegrator::AddEmission(const PathWalk &walk, Subpath &path, Sample &sample) const {
    walk.ForEachEmission(sample.lambda, [&](const SampledSpectrum &Le, LightId id, const Point3 &p, const Normal3 &n) {
        BdptVertex light;
        light.kind = BdptVertex::Kind::Light;
        light.light = id;
        light.p = p;
        light.n = n;
        light.isBeyondScene = n == Normal3(0);
        light.direction = -walk.GetRay().d;
        light.pdfForward = light.AreaPdf(path.Last(), path.pdf);
        const SampledSpectrum arriving = path.weights.beta * Le;
        const Float weight = WeightOf(sample, 0, path.count, &light, 0);
        const SampledSpectrum L = arriving * weight;
        const Float mean = hasMedia_ ? path.weights.ru.Average() : 1;
        path.L += hasMedia_ ? L / mean : L;
        path.ofFirst += L[0];
        if (strategies_) sample.paths.contributions.push_back({0, path.count + 1, arriving / mean, L / mean, {}, mean});
    });
}

Float BdptIntegrator::WeightOf(Sample &sample, int lightVertices, int cameraVertices, const BdptVertex *end,
                               Float cameraPdf) const {
    const Subpaths &paths = sample.paths;
    size_t n = 0;
    auto &path = sample.paths.path;
    if (end) path[n++] = end;
    for (int i = end && lightVertices > 0 ? 1 : 0; i < lightVertices; ++i) path[n++] = &paths.light[i];
    for (int i = cameraVertices - 1; i >= 0; --i) path[n++] = &paths.camera[i];
    return weights_.Weight({path.data(), n}, lightVertices, cameraPdf, sample.lambda);
}

ShadowTransmittance BdptIntegrator::Passing(const Sample &sample, const BdptVertex &from,
                                            const LightLiSample &to) const {
    if (!hasMedia_) return TraceShadowRay(context_.scene, from.Context(), to);
    Rng rng(Hash(from.Position(), to.wi, to.pLight));
    return TraceShadow(context_.scene, from.Context(), from.MediumTowards(to.wi), to, sample.lambda, rng);
}

SampledSpectrum BdptIntegrator::Passed(const Sample &sample, const SampledSpectrum &L,
                                       const ShadowTransmittance &through, const SampledSpectrum &densities) const {
    if (!hasMedia_) return L;
    const SampledSpectrum all = densities * through.rl;
    return L * through.value / (sample.lambda.SecondaryTerminated() ? all[0] : all.Average());
}

SampledSpectrum BdptIntegrator::ConnectToLight(Sample &sample, int cameraVertices) const {
    const Scene &scene = context_.scene;
    const BdptVertex &last = sample.paths.camera[cameraVertices - 1];
    const BdptVertex &beyond = sample.paths.camera[cameraVertices - 2];
    const LightQuery query = last.Query(last.Towards(beyond), sample.lambda, cameraVertices - 1);
    Sampler &sampler = sample.samplers.connections;
    const Point2 u = sampler.Get2D();
    LightMemory memory;
    const LightDistribution lights = (connecting_ ? *connecting_ : *shooting_).At(query, memory);
    const LightSampleContext from =
        last.IsSurface() ? ScatteringContextAt(scene, last.surface.point, last.surface.bsdf) : last.Context();
    const std::optional<DirectLight> direct = SampleDirectLight(
        scene.Lights(), lights, from, sample.lambda, false, sampler.Get1D(), u, sample.observed,
        [&](const Vector3 &wi) {
            return Scattering{last.F(wi), last.Cosine(wi)};
        },
        [&](const LightLiSample &to, const Point2 &) { return Passing(sample, last, to); });
    if (!direct) return SampledSpectrum(0);
    const auto &[chosen, found, to, through, isDelta] = *direct;
    const SampledSpectrum L = last.beta * to.f * found.L * (to.cosine / direct->Pdf());
    BdptVertex end;
    end.kind = BdptVertex::Kind::Light;
    const LightKind kind = scene.Lights()[chosen.light].Kind();
    end.light = chosen.light;
    end.p = found.pLight;
    end.n = found.nLight;
    end.isBeyondScene = kind == LightKind::Infinite || kind == LightKind::DeltaDirection;
    end.direction = -found.wi;
    end.pdfForward = weights_.LightPdf(end, last);
    const SampledSpectrum weighted = Passed(sample, L * WeightOf(sample, 1, cameraVertices, &end, 0), through, last.ru);
    if (strategies_)
        sample.paths.contributions.push_back({1, cameraVertices, Passed(sample, L, through, last.ru), weighted});
    return weighted;
}

SampledSpectrum BdptIntegrator::ConnectSubpaths(Sample &sample, int lightVertices, int cameraVertices) const {
    const BdptVertex &a = sample.paths.light[lightVertices - 1], &b = sample.paths.camera[cameraVertices - 1];
    const Vector3 d = b.Position() - a.Position();
    const Float l2 = LengthSquared(d);
    if (!(l2 > 0)) return SampledSpectrum(0);
    const Vector3 w = d / std::sqrt(l2);
    const SampledSpectrum L =
        a.beta * a.F(w, TransportMode::Importance) * (a.CosineOfLight(w) / l2) * b.F(-w) * b.Cosine(w) * b.beta;
    if (!L) return L;
    LightLiSample end;
    end.wi = -w;
    end.pLight = a.Position();
    if (a.IsSurface()) end.pLightError = a.surface.point.pError;
    end.nLight = a.Normal();
    const ShadowTransmittance through = Passing(sample, b, end);
    if (!through.value) return SampledSpectrum(0);
    const SampledSpectrum ru = a.ru * b.ru;
    const SampledSpectrum weighted =
        Passed(sample, L * WeightOf(sample, lightVertices, cameraVertices, nullptr, 0), through, ru);
    if (strategies_)
        sample.paths.contributions.push_back({lightVertices, cameraVertices, Passed(sample, L, through, ru), weighted});
    return weighted;
}

void BdptIntegrator::ConnectToCamera(Sample &sample, int lightVertices, std::vector<CameraSplat> &splats) const {
    const Point2 uLens = sample.samplers.connections.Get2D();
    const BdptVertex &last = sample.paths.light[lightVertices - 1];
    if (!last.CanConnect()) return;
    const std::optional<CameraConnection> connection = context_.camera.Connect(last.Position(), uLens, sample.time);
    if (!connection) return;
    const SampledSpectrum L = last.beta * last.F(connection->wi, TransportMode::Importance) *
                              (last.CosineOfLight(connection->wi) * connection->weight * sample.splatUnit);
    if (!L) return;
    const LightLiSample lens{.L = {}, .wi = connection->wi, .pLight = connection->p};
    const ShadowTransmittance through = Passing(sample, last, lens);
    if (!through.value) return;
    // These connections come last: the camera path's camera vertex is not needed afterwards.
    BdptVertex &camera = sample.paths.camera[0];
    camera.p = connection->p;
    camera.direction = -connection->wi;
    const Float cameraPdf = last.AreaPdfOfParallel(connection->weight, connection->wi) / sample.pixels;
    const Float weight = WeightOf(sample, lightVertices, 1, nullptr, cameraPdf);
    const SampledSpectrum weighted = Passed(sample, L * weight, through, last.ru);
    const auto add = [&](const Point2 &pFilm) {
        splats.push_back({pFilm, weighted});
        if (strategies_)
            sample.paths.contributions.push_back(
                {lightVertices, 1, Passed(sample, L, through, last.ru), weighted, pFilm});
    };
    add(connection->pFilm);
    Camera::OtherPlaces places;
    for (int i = 0, n = context_.camera.WrappedPositions(connection->pFilm, places); i < n; ++i) add(places[i]);
}

SampledSpectrum BdptIntegrator::TracePair(const PathStart &start, SampledWavelengths &lambda, const Samplers &samplers,
                                          Float pixels, Float splatUnit, std::vector<CameraSplat> &splats) const {
    ++ThreadCounters().cameraPaths;
    Subpaths &paths = subpaths_[ThreadIndex()];
    const ObservedPath observed(observer_, start.pixel, start.sampleIndex);
    Sample sample{start, lambda, samplers, paths, start.ray.ray.time, pixels, splatUnit, observed};
    TraceLight(sample);
    SampledSpectrum L = TraceCamera(sample);
    for (int t = 2; t <= paths.cameraCount; ++t) {
        if (!paths.camera[t - 1].CanConnect()) continue;
        L += ConnectToLight(sample, t);
        for (int s = 2; s <= paths.lightCount && s + t - 2 <= maxDepth_; ++s)
            if (paths.light[s - 1].CanConnect()) L += ConnectSubpaths(sample, s, t);
    }
    for (int s = 2; s <= paths.lightCount; ++s) ConnectToCamera(sample, s, splats);
    return L;
}

SampledSpectrum BdptIntegrator::Li(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler) const {
    const RenderPass &pass = start.pass;
    Subpaths &paths = subpaths_[ThreadIndex()];
    std::vector<CameraSplat> &splats = paths.splats;
    splats.clear();
    paths.contributions.clear();
    const SampledSpectrum L = TracePair(start, lambda, {sampler, sampler, sampler},
                                        Float(pass.film.PixelBounds().Area()), pass.film.SplatUnit(), splats);
    if (!pass.keepsSamples) return L;
    for (const CameraSplat &s : splats) {
        AddFilteredSplat(pass.film, pass.filter, s.pFilm, s.L, lambda);
        if (start.half) AddFilteredSplat(*start.half, pass.filter, s.pFilm, s.L, lambda);
    }
    if (strategies_) {
        ++paths.pairs;
        strategies_->Add(paths.contributions, start.pixel, start.filterWeight, lambda, pass.filter);
    }
    return L;
}

}  // namespace pbrt
