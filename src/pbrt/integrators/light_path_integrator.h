#pragma once
#include "pbrt/core/counters.h"
#include "pbrt/integrators/integrator.h"
#include "pbrt/integrators/pixel_integrator.h"
#include "pbrt/lightsamplers/simple_light_samplers.h"
#include "pbrt/transport/shadow_transmittance.h"
#include "pbrt/transport/vertex.h"

namespace pbrt {

/// Particle tracing (Arvo and Kirk 1990; Veach 1997, section 10.3.4). Every pixel sample traces one path from a light;
/// vertices visible to the camera add splats at their film position. As in stock pbrt-v4, objects visible through
/// mirrors or smooth glass, directly visible lights outside the scene, and medium emission stay dark.
class LightPathIntegrator final : public PixelIntegrator {
  public:
    /// The camera must support Camera::CanConnect. `lights` selects where paths start, with position-independent
    /// probabilities; null: by power.
    LightPathIntegrator(const PathContext &context, int maxDepth, std::unique_ptr<LightSampler> lights = nullptr)
        : context_(context), maxDepth_(maxDepth), lights_(ByPowerUnless(std::move(lights), context.scene.Lights())) {}
    void Prepare(PrepareContext &prepare) override { lights_->Prepare(prepare); }
    const LightSampler *EmissionSampler() const override { return lights_.get(); }
    /// Splats; returns radiance 0.
    SampledSpectrum Li(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler) const override {
        ++ThreadCounters().cameraPaths;
        LightPath path(*this, start, lambda, sampler);
        if (const std::optional<Ray> ray = path.Begin()) path.Follow(*ray);
        return SampledSpectrum(0);
    }
    bool Splats() const override { return true; }

  private:
    class LightPath {
      public:
        LightPath(const LightPathIntegrator &integrator, const PathStart &start, SampledWavelengths &lambda,
                  Sampler &sampler)
            : integrator_(integrator), context_(integrator.context_), pass_(start.pass), time_(start.ray.ray.time),
              splatUnit_(start.pass.film.SplatUnit()), hasMedia_(context_.scene.HasMedia()), lambda_(lambda),
              sampler_(sampler) {}

        /// Samples the first ray and splats the light at its origin.
        std::optional<Ray> Begin() {
            const Scene &scene = context_.scene;
            const std::optional<SampledLight> chosen = integrator_.lights_->Sample({.time = time_}, sampler_.Get1D());
            const Point2 uPosition = sampler_.Get2D(), uDirection = sampler_.Get2D(), uFirst = sampler_.Get2D();
            if (!chosen || !(chosen->pmf > 0)) return {};
            const LightComponent light = scene.Lights()[chosen->light];
            std::optional<LightLeSample> left = light.SampleLe(uPosition, uDirection, lambda_);
            if (!left) return {};
            const Float pdfPosition = chosen->pmf * left->pdfPosition;
            const bool hasSurface = left->n != Normal3(0);
            const auto mediumTowards = [&](const Vector3 &w) { return scene.MediumOfLight(chosen->light, left->n, w); };
            if (hasSurface && !IsDelta(light.Kind())) {
                const LightSampleContext from{left->p, left->pError, left->n, left->n, time_};
                Splat(from, uFirst, mediumTowards, [&](const Vector3 &wi) {
                    // Surface radiance is equal in all emitting directions.
                    return light.L(left->p, left->n, left->uv, wi, lambda_)
                               ? left->L * (AbsDot(left->n, wi) / pdfPosition)
                               : SampledSpectrum(0);
                });
            }
            SampledSpectrum &beta = weights_.beta;
            beta = left->L / (pdfPosition * left->pdfDirection);
            if (hasSurface) beta *= AbsDot(left->n, left->ray.d);
            Ray ray = left->ray;
            ray.time = time_;
            ray.medium = mediumTowards(ray.d);
            return ray;
        }

        void Follow(const Ray &ray) {
            PathWalk walk(context_, ray);
            const auto track = [&] {
                return hasMedia_ ? walk.ThroughMedium(lambda_, sampler_, false, weights_, [](auto &&, Float) {})
                                 : MediumEvent{};
            };
            for (int depth = 0;; ++depth) {
                const std::optional<ReachedVertex> reached =
                    walk.NextVertex(lambda_, weights_, track, [](PathWalk::Met) {});
                if (!reached || depth == integrator_.maxDepth_) return;
                ++ThreadCounters().pathVertices;
                if (reached->phase) ScatterInMedium(walk, *reached->phase, reached->p);
                else if (!ScatterAtSurface(walk)) return;
            }
        }

      private:
        /// Splats radiance `leaving`(wi) from `from`, in the medium `mediumTowards`(wi) on that side, if visible to the
        /// camera.
        void Splat(const LightSampleContext &from, const Point2 &uLens, auto &&mediumTowards, auto &&leaving) {
            const std::optional<CameraConnection> connection = context_.camera.Connect(from.p, uLens, time_);
            if (!connection) return;
            SampledSpectrum radiance = leaving(connection->wi) * (connection->weight * splatUnit_);
            if (!radiance) return;
            const LightLiSample lens{.L = {}, .wi = connection->wi, .pLight = connection->p};
            if (hasMedia_) {
                Rng rng(Hash(from.p, lens.wi, lens.pLight));
                const ShadowTransmittance through =
                    TraceShadow(context_.scene, from, mediumTowards(connection->wi), lens, lambda_, rng);
                if (!through.value) return;
                weights_.onlyFirst = lambda_.SecondaryTerminated();
                radiance = radiance * through.value / weights_.Mean(weights_.ru * through.rl);
            } else if (context_.scene.Occluded(from, lens)) {
                return;
            }
            if (!pass_.keepsSamples) return;
            AddFilteredSplat(pass_.film, pass_.filter, connection->pFilm, radiance, lambda_);
            Camera::OtherPlaces places;
            for (int i = 0, n = context_.camera.WrappedPositions(connection->pFilm, places); i < n; ++i)
                AddFilteredSplat(pass_.film, pass_.filter, places[i], radiance, lambda_);
        }

        void ScatterInMedium(PathWalk &walk, const HenyeyGreenstein &phase, const Point3 &p) {
            const Ray &at = walk.GetRay();
            const Vector3 wo = -at.d;
            Splat(
                {p, {}, {}, {}, time_}, sampler_.Get2D(), [&](const Vector3 &) { return at.medium; },
                [&](const Vector3 &wi) { return weights_.beta * phase.P(wo, wi); });
            walk.ScatterInMedium(p, phase.SampleP(wo, sampler_.Get2D()).wi);
        }

        /// Returns false if the path ends.
        bool ScatterAtSurface(PathWalk &walk) {
            SampledSpectrum &beta = weights_.beta;
            const auto &[point, bsdf] = walk.Vertex();
            const Point2 uLens = sampler_.Get2D();
            if (IsNonSpecular(bsdf.Flags()))
                Splat(
                    LightContextAt(point), uLens, [&](const Vector3 &wi) { return point.MediumTowards(wi); },
                    [&](const Vector3 &wi) {
                        return beta * bsdf.F(point.wo, wi, TransportMode::Importance) *
                               AdjointCosine(point, point.wo, wi);
                    });
            const Float uComponent = sampler_.Get1D();
            const std::optional<BsdfSample> sample =
                bsdf.Sample(point.wo, uComponent, sampler_.Get2D(), TransportMode::Importance);
            if (!sample) return false;
            beta *= sample->f * (AdjointCosine(point, point.wo, sample->wi) / sample->pdf);
            if (!beta) return false;
            walk.Scatter(*sample);
            return true;
        }

        const LightPathIntegrator &integrator_;
        const PathContext &context_;
        const RenderPass &pass_;
        const Float time_, splatUnit_;
        const bool hasMedia_;
        SampledWavelengths &lambda_;
        Sampler &sampler_;
        SpectralWeights weights_;
    };

    PathContext context_;
    int maxDepth_;
    std::unique_ptr<LightSampler> lights_;
};

}  // namespace pbrt
