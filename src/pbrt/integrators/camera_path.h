#pragma once
#include "pbrt/integrators/pixel_integrator.h"
#include "pbrt/lights/environment_light.h"
#include "pbrt/transport/direct_light.h"
#include "pbrt/transport/medium_track.h"
#include "pbrt/transport/path_walk.h"
#include "pbrt/transport/vertex.h"

namespace pbrt {

/// Parameters of a CameraPath, from the scene's integrator and the command line; constant during a render.
struct PathSettings {
    int maxDepth = 5;         ///< scattering events; 0: emission only, 1: direct light
    bool regularize = false;  ///< roughen specular lobes after the first non-specular bounce
    bool subsurface = false;  ///< subsurface scattering (volpath; path renders clear dielectrics, as in stock)
    /// Shadow rays pass interface surfaces (volpath, in scenes built so that they pass them; in path they block, as in
    /// stock).
    bool passesInterfaces = false;
    /// Excludes emission reached only by BSDF sampling: directly visible or mirrored lights, caustics. It is
    /// independent of the light sampler and would add noise to comparisons.
    bool sampledLightOnly = false;
    /// Minimum continuation probability of roulette: 0 as in stock, 1 for no roulette.
    Float minContinuation = 0;
    bool tracksMedia = false;  ///< volpath in a scene with media
};

/// What all paths of a render share. Owns nothing: its members must outlive the paths.
struct CameraPathSetup {
    const PathContext &context;
    const PathSettings &settings;
    const LightSampler &lights;
    PathObserver *observer = nullptr;  ///< of light samples; may be null
    /// Table that light samples draw from with the sampler's numbers, for reading ahead; may be null.
    const EnvironmentTable *environment = nullptr;
};

/// Path throughput without media. MIS by the power heuristic, as in stock pbrt-v4.
class SurfaceThroughput {
  public:
    static constexpr bool kHasMedia = false;
    SampledSpectrum beta{1};

    SampledSpectrum Weight() const { return beta; }
    SampledSpectrum Scaled(Float scale) const { return beta * scale; }
    /// Called for a sampled scattering direction (density by solid angle) that light sampling could replace.
    void SampledDirection(Float pdf) { pScatter_ = pdf; }
    /// Contribution of emission hit; `pLight`: density of light sampling (solid angle), 0: not sampled.
    SampledSpectrum Emission(const SampledSpectrum &Le, Float pLight) const {
        return beta * Le * EmissionWeight(pScatter_, pLight);
    }
    /// Contribution of a light sample; pScatter(wi): scattering density (solid angle).
    template <class Pdf>
    SampledSpectrum Direct(const DirectLight &light, Pdf &&pScatter) const {
        const Float pLight = light.Pdf();
        if (light.isDelta) return beta * (light.sample.L * light.F() / pLight);
        return beta * (light.sample.L * light.F() * (PowerHeuristic(pLight, pScatter(light.sample.wi)) / pLight));
    }

  private:
    Float pScatter_ = 0;
};

/// Path throughput with media (SpectralWeights). MIS by the balance heuristic, over wavelengths as well.
class MediaThroughput : public SpectralWeights {
  public:
    static constexpr bool kHasMedia = true;

    SampledSpectrum Weight() const { return beta / Mean(ru); }
    SampledSpectrum Scaled(Float scale) const { return beta * scale / Mean(ru); }
    SampledSpectrum Emission(const SampledSpectrum &Le, Float pLight) const {
        SampledSpectrum densities = ru;
        if (pLight > 0) densities += rl * pLight;
        return beta * Le / Mean(densities);
    }
    template <class Pdf>
    SampledSpectrum Direct(const DirectLight &light, Pdf &&pScatter) const {
        const ShadowTransmittance &through = light.through;
        SampledSpectrum densities = ru * through.rl * light.Pdf();
        if (!light.isDelta) densities += ru * through.ru * pScatter(light.sample.wi);
        return beta * light.F() * light.sample.L * through.value / Mean(densities);
    }
};

struct NoGathering {
    static constexpr bool IsLastRay() { return false; }
    static constexpr bool GathersAt(const PathVertex &) { return false; }
    static SampledSpectrum At(const PathVertex &, const SampledSpectrum &, int) { return SampledSpectrum(0); }
    void Leave(const PathVertex &, const BsdfSample &) {}
    void End(SampledSpectrum &, const SampledWavelengths &) {}
};

/// Camera path with next-event estimation: the algorithm of path, volpath and the camera pass of sppm. Three policies:
///
///   Throughput   SurfaceThroughput or MediaThroughput: weights, MIS heuristic, and medium tracking
///   Gathering    NoGathering, or estimates of indirect light at surfaces that end the path
///   Directions   surface directions with densities, continuation probabilities, and records of the path; in call
///                order, with throughput `beta` and accumulated radiance `L`:
///
///     RecordHit[InMedium](vertex)                          the path arrived
///     HasLearnedRoulette()                                 roulette happens on arrival, not after scattering
///     ContinuationProbability[InMedium](vertex, mean beta) 0: no estimate
///     PrepareDirections(vertex, beta)                      before Sample and Pdf, at surfaces
///     BeginVertex[InMedium](vertex, beta, L)               before next-event estimation
///     Pdf(vertex, wi)                                      solid angle, without specular lobes
///     ContinuationProbabilityAfterNee(mean beta)           1: no estimate
///     BeginScattering(beta, L)
///     Sample(vertex, uc, u)
///     RecordScatter(vertex, sample, pdf, L, beta)          after non-specular scattering
///     End(L)
template <class Throughput, class Directions, class Gathering = NoGathering>
class CameraPath {
  public:
    CameraPath(const CameraPathSetup &setup, const CameraPathStart &start, SampledWavelengths &lambda, Sampler &sampler,
               Directions &directions, Gathering gathering = {})
        : setup_(setup), scene_(setup.context.scene), settings_(setup.settings), lambda_(lambda), sampler_(sampler),
          directions_(directions), gathering_(gathering), walk_(setup.context, start.ray, start.visible),
          observed_(setup.observer, start.pixel, start.sampleIndex) {}

    /// Returns the radiance along the camera ray.
    SampledSpectrum Follow() {
        while (Step()) {
        }
        gathering_.End(L_, lambda_);
        directions_.End(L_);
        ++ThreadCounters().cameraPaths;
        return L_;
    }

  private:
    enum class Passed { Through, Scattered, Ended };

    /// Advances to the next vertex. Returns false if the path ends.
    bool Step() {
        const EnvironmentTable::Lookahead lookahead = LookAheadForLightSample();
        const PathWalk::Met met = walk_.Next();
        lookahead.Continue();
        if (met == PathWalk::Met::TooManyInterfaces) return false;
        if constexpr (Throughput::kHasMedia)
            if (const Medium *medium = walk_.MediumAhead())
                if (const Passed passed = PassMedium(*medium); passed != Passed::Through)
                    return passed == Passed::Scattered;
        AddEmission(met);
        if (met == PathWalk::Met::Nothing) return false;
        bool scatters;
        if constexpr (Throughput::kHasMedia) scatters = walk_.FindScattering(lambda_, throughput_);
        else scatters = walk_.FindScattering(lambda_);
        if (scatters) return ScatterAtSurface();
        if (!settings_.passesInterfaces) lightCouldSample_ = false;
        return true;
    }

    /// Reads ahead for the light sample of the next vertex while its ray is traced.
    EnvironmentTable::Lookahead LookAheadForLightSample() {
        if (!setup_.environment) return {};
        const bool drawsRoulette = directions_.HasLearnedRoulette() && depth_ >= 2;
        const Point2 *const u = sampler_.Upcoming2D(drawsRoulette ? 2 : 1);
        return u ? EnvironmentTable::Lookahead(*setup_.environment, *u) : EnvironmentTable::Lookahead();
    }

    void AddEmission(PathWalk::Met met) {
        walk_.ForEachEmission(lambda_, [&](const SampledSpectrum &Le, LightId id, const Point3 &p, const Normal3 &n) {
            if (!lightCouldSample_ && settings_.sampledLightOnly) return;
            const Float pLight =
                !lightCouldSample_
                    ? Float(0)
                    : previous_->LightPdf(scene_.Lights(), id, met == PathWalk::Met::Nothing, walk_.GetRay().d, p, n);
            L_ += throughput_.Emission(Le, pLight);
        });
    }

    Passed PassMedium(const Medium &medium) {
        const Ray &ray = walk_.GetRay();
        // Medium emission before the last vertex is excluded, as in stock pbrt-v4.
        const bool emits = depth_ < settings_.maxDepth && !settings_.sampledLightOnly;
        const MediumEvent event = walk_.ThroughMedium(lambda_, sampler_, emits, throughput_,
                                                      [&](const SampledSpectrum &radiance, Float) { L_ += radiance; });
        if (event.kind == MediumEvent::Kind::Absorbed || !throughput_.beta) return Passed::Ended;
        if (event.kind == MediumEvent::Kind::Passed) return Passed::Through;
        if (depth_++ == settings_.maxDepth) return Passed::Ended;
        ++ThreadCounters().pathVertices;
        return ScatterInMedium(ray(event.t), medium.Phase()) ? Passed::Scattered : Passed::Ended;
    }

    bool ScatterInMedium(const Point3 &p, const HenyeyGreenstein &phase) {
        const Ray &ray = walk_.GetRay();
        const Vector3 wo = -ray.d;
        directions_.RecordHitInMedium(p);
        if (directions_.HasLearnedRoulette() && depth_ > 1) {
            const Float probability = directions_.ContinuationProbabilityInMedium(p, throughput_.Weight().Average());
            if (probability > 0 && !Continues(probability)) return false;
        }
        directions_.BeginVertexInMedium(p, throughput_.Weight(), L_);
        current_->Prepare(setup_.lights, LightQueryInMedium(p, wo, ray.medium, phase, ray.time, lambda_, depth_),
                          {p, {}, {}, {}, ray.time});
        const Float uLight = sampler_.Get1D();
        const std::optional<DirectLight> light = SampleDirectLight(
            scene_.Lights(), current_->lights, current_->from, lambda_, true, uLight, sampler_.Get2D(), observed_,
            [&](const Vector3 &wi) {
                return Scattering{SampledSpectrum(phase.P(wo, wi)), 1};
            },
            [&](const LightLiSample &to, const Point2 &u) { return TraceThroughMedia(to, u, ray.medium); });
        if (light) L_ += throughput_.Direct(*light, [&](const Vector3 &wi) { return phase.P(wo, wi); });
        if (!Continues(directions_.ContinuationProbabilityAfterNee(throughput_.Weight().Average()))) return false;
        directions_.BeginScattering(throughput_.Weight(), L_);
        const HenyeyGreenstein::Sample sample = phase.SampleP(wo, sampler_.Get2D());
        if (!(sample.p > 0)) return false;
        LeaveVertex(sample.p);
        walk_.ScatterInMedium(p, sample.wi);
        return true;
    }

    bool ScatterAtSurface() {
        if (settings_.regularize && anyNonSpecular_) walk_.Regularize();
        const auto &[point, bsdf] = walk_.Vertex();
        directions_.RecordHit(walk_.Vertex());
        if (gathering_.IsLastRay() || depth_++ == settings_.maxDepth) return false;
        ++ThreadCounters().pathVertices;
        if (directions_.HasLearnedRoulette() && depth_ > 1) {
            // Without an estimate, and at specular surfaces, roulette is by throughput. Light is always sampled at the
            // first two vertices.
            const Float probability =
                directions_.ContinuationProbability(walk_.Vertex(), throughput_.Weight().Average());
            if (depth_ > 2 && !(probability > 0 ? Continues(probability) : ContinuesByThroughput())) return false;
        }
        directions_.PrepareDirections(walk_.Vertex(), throughput_.Weight());
        if (IsNonSpecular(bsdf.Flags())) {
            directions_.BeginVertex(walk_.Vertex(), throughput_.Weight(), L_);
            AddDirectLight();
        }
        if (gathering_.GathersAt(walk_.Vertex())) L_ += gathering_.At(walk_.Vertex(), throughput_.beta, depth_);
        if (!Continues(directions_.ContinuationProbabilityAfterNee(throughput_.Weight().Average()))) return false;
        directions_.BeginScattering(throughput_.Weight(), L_);

        const Float uComponent = sampler_.Get1D();
        const std::optional<BsdfSample> sample = directions_.Sample(walk_.Vertex(), uComponent, sampler_.Get2D());
        if (!sample) return false;
        throughput_.beta *= sample->f * (AbsDot(sample->wi, point.shading.n) / sample->pdf);
        if (!throughput_.beta) return false;
        if (IsSpecular(sample->flags)) {
            lightCouldSample_ = false;
        } else {
            const Float pdf = sample->pdfIsProportional ? bsdf.Pdf(point.wo, sample->wi) : sample->pdf;
            LeaveVertex(pdf);
            directions_.RecordScatter(walk_.Vertex(), *sample, pdf, L_, throughput_.Weight());
        }
        gathering_.Leave(walk_.Vertex(), *sample);
        if (IsTransmissive(sample->flags)) etaScale_ *= Sqr(sample->eta);
        walk_.Scatter(*sample);
        if (settings_.subsurface && IsTransmissive(sample->flags) && !PassBelowSurface()) return false;
        return directions_.HasLearnedRoulette() || depth_ <= 1 || gathering_.IsLastRay() || ContinuesByThroughput();
    }

    /// Subsurface scattering counts as one scattering event, as in stock. Returns false if the path ends.
    bool PassBelowSurface() {
        const std::optional<Bssrdf> bssrdf = ComputeBssrdf(scene_, walk_.Vertex().point, lambda_);
        if (!bssrdf) return true;
        const std::optional<SubsurfaceExit> exit =
            SampleSubsurfaceExit(scene_, walk_.Vertex().point, *bssrdf, sampler_);
        if (!exit) return false;
        throughput_.beta *= exit->weight;
        walk_.MoveTo(exit->vertex);
        directions_.PrepareDirections(walk_.Vertex(), throughput_.Weight());
        AddDirectLight();
        const Float uExit = sampler_.Get1D();
        const std::optional<BsdfSample> sample = directions_.Sample(walk_.Vertex(), uExit, sampler_.Get2D());
        if (!sample) return false;
        throughput_.beta *= sample->f * (AbsDot(sample->wi, walk_.Vertex().point.shading.n) / sample->pdf);
        LeaveVertex(sample->pdf);
        directions_.RecordScatter(walk_.Vertex(), *sample, sample->pdf, L_, throughput_.Weight());
        walk_.Scatter(*sample);
        return true;
    }

    void AddDirectLight() {
        const PathVertex &vertex = walk_.Vertex();
        current_->Prepare(setup_.lights, vertex, lambda_, depth_);
        // All random numbers are drawn unconditionally, so that dimensions stay aligned between samples.
        const Float uLight = sampler_.Get1D();
        const std::optional<DirectLight> light =
            SampleDirectLight(scene_, vertex, current_->lights, lambda_, true, uLight, sampler_.Get2D(), observed_,
                              [&](const LightLiSample &to, [[maybe_unused]] const Point2 &u) {
                                  if constexpr (Throughput::kHasMedia)
                                      return TraceThroughMedia(to, u, vertex.point.MediumTowards(to.wi));
                                  else return TraceShadowRay(scene_, current_->from, to);
                              });
        if (light) L_ += throughput_.Direct(*light, [&](const Vector3 &wi) { return directions_.Pdf(vertex, wi); });
    }

    ShadowTransmittance TraceThroughMedia(const LightLiSample &to, const Point2 &u, MediumId medium) {
        Rng rng(Hash(current_->from.p, to.wi, u));
        return TraceShadow(scene_, current_->from, medium, to, lambda_, rng);
    }

    /// Leaves the vertex by scattering of this density (solid angle) that light sampling could replace.
    void LeaveVertex(Float pdf) {
        throughput_.SampledDirection(pdf);
        std::swap(current_, previous_);
        lightCouldSample_ = anyNonSpecular_ = true;
    }

    /// Russian roulette. Returns false if the path ends.
    bool Continues(Float probability) {
        if (!(probability < 1)) return true;
        if (sampler_.Get1D() >= probability) return false;
        throughput_.beta /= probability;
        return true;
    }
    /// Uses the throughput without the radiance scaling of refraction.
    bool ContinuesByThroughput() {
        return Continues(std::max(throughput_.Scaled(etaScale_).MaxComponent(), settings_.minContinuation));
    }

    const CameraPathSetup &setup_;
    const Scene &scene_;
    const PathSettings &settings_;
    SampledWavelengths &lambda_;
    Sampler &sampler_;
    Directions &directions_;
    Gathering gathering_;
    PathWalk walk_;
    ObservedPath observed_;
    SampledSpectrum L_{0};
    Throughput throughput_;
    VertexSelection selections_[2];
    /// The current vertex and the last scattering vertex, for the light-sampling density of emission hit.
    VertexSelection *current_ = &selections_[0], *previous_ = &selections_[1];
    int depth_ = 0;
    Float etaScale_ = 1;
    bool lightCouldSample_ = false;  ///< light sampling at `previous_` covers the next emission
    bool anyNonSpecular_ = false;
};

/// Policy of CameraPath, which documents the functions: BSDF directions and roulette by throughput.
struct BsdfDirections {
    static constexpr bool HasLearnedRoulette() { return false; }
    static constexpr Float ContinuationProbability(const PathVertex &, Float) { return 0; }
    static constexpr Float ContinuationProbabilityInMedium(const Point3 &, Float) { return 0; }
    static constexpr Float ContinuationProbabilityAfterNee(Float) { return 1; }
    void BeginScattering(const SampledSpectrum &, const SampledSpectrum &) {}
    void BeginVertex(const PathVertex &, const SampledSpectrum &, const SampledSpectrum &) {}
    void BeginVertexInMedium(const Point3 &, const SampledSpectrum &, const SampledSpectrum &) {}
    void RecordHit(const PathVertex &) {}
    void RecordHitInMedium(const Point3 &) {}
    void PrepareDirections(const PathVertex &, const SampledSpectrum &) {}
    std::optional<BsdfSample> Sample(const PathVertex &vertex, Float uc, const Point2 &u) const {
        return vertex.bsdf.Sample(vertex.point.wo, uc, u);
    }
    Float Pdf(const PathVertex &vertex, const Vector3 &wi) const { return vertex.bsdf.Pdf(vertex.point.wo, wi); }
    void RecordScatter(const PathVertex &, const BsdfSample &, Float, const SampledSpectrum &,
                       const SampledSpectrum &) {}
    void End(const SampledSpectrum &) {}
};

}  // namespace pbrt
