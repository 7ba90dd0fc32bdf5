#pragma once
#include <memory>

#include "pbrt/core/memory.h"
#include "pbrt/core/parallel.h"
#include "pbrt/core/progress.h"
#include "pbrt/integrators/camera_path.h"
#include "pbrt/integrators/photon_map.h"
#include "pbrt/lightsamplers/simple_light_samplers.h"
#include "pbrt/math/rng.h"
#include "pbrt/math/sobol.h"
#include "pbrt/math/warps.h"
#include "pbrt/transport/vertex.h"

namespace pbrt {

struct SppmSettings {
    int maxDepth = 5;               ///< scattering events of the whole path
    int photonsPerIteration = -1;   ///< light paths; -1: one per film pixel
    Float radius = 1;               ///< of the first iteration, in scene units
    int seed = 0;                   ///< of the light paths
    bool sampledLightOnly = false;  ///< excludes emission reached only by BSDF sampling
};

/// Stochastic progressive photon mapping (Hachisuka and Jensen 2009). Each sample per pixel is an iteration. Light
/// paths leave photons at surfaces, except at the first. Camera paths are traced to the first diffuse surface: direct
/// light there from light and BSDF sampling, the rest from photons within a radius. The image is the mean over
/// iterations. The radius depends on the iteration only (Knaus and Zwicker 2011), so iterations are independent and a
/// render can be divided. Surfaces only.
class SppmIntegrator final : public PixelIntegrator {
  public:
    SppmIntegrator(const PathContext &context, const SppmSettings &settings, std::unique_ptr<LightSampler> lights,
                   std::unique_ptr<LightSampler> shooting = nullptr)
        : context_(context), settings_(settings), lights_(std::move(lights)),
          shooting_(ByPowerUnless(std::move(shooting), context.scene.Lights())) {
        path_.maxDepth = settings.maxDepth;
        path_.sampledLightOnly = settings.sampledLightOnly;
    }
    void Prepare(PrepareContext &prepare) override {
        lights_->Prepare(prepare);
        shooting_->Prepare(prepare);
    }
    /// One iteration (MaxPassSamples).
    bool Render(const RenderPass &pass) override {
        // All randomness of an iteration derives from the samplers, so it depends on their seed.
        Sampler &sampler = *pass.samplers[0];
        sampler.StartPixelSample({0, 0}, 0);
        const Float u[] = {sampler.Get1D(), sampler.Get1D(), sampler.Get1D(), sampler.Get1D()};
        seed_ = Hash(u[0], u[1], u[2], u[3], settings_.seed);
        // All pixels share the error of few wavelength sets and times; even spacing minimizes it.
        const auto spaced = [&](uint32_t base, Float shift) {
            const Float shifted = RadicalInverse(base, uint64_t(pass.first)) + shift;
            return shifted - std::floor(shifted);
        };
        common_ = {pass.jittersWavelengths ? spaced(2, HashToFloat(seed_)) : Float(0.5),
                   pass.jittersPixels ? spaced(3, HashFloat(seed_)) : Float(0.5)};
        const SampledWavelengths lambda = pass.film.SampleWavelengths(common_.wavelengths);

        const Float radius = settings_.radius * RelativeRadius(pass.samplesBefore + pass.batchFirst + pass.first);
        const int64_t paths =
            settings_.photonsPerIteration > 0 ? settings_.photonsPerIteration : pass.film.PixelBounds().Area();
        RequireMemory(double(paths) * sizeof(Photon), fmt::format("Integrator \"sppm\": a map of {} photons", paths),
                      {});
        perArea_ = 1 / (Pi * radius * radius * Float(paths));
        const int64_t groupCount = settings_.maxDepth < 2 ? 0 : (paths + kGroup - 1) / kGroup;
        std::vector<std::vector<Photon>> groups(groupCount);
        ParallelForEach(groupCount, [&](int64_t group) {
            if (pass.progress.Cancelled()) return;
            const int64_t end = std::min(paths, (group + 1) * kGroup);
            for (int64_t i = group * kGroup; i < end; ++i)
                TraceLightPath(lambda, uint64_t(pass.first * paths + i), groups[group]);
        });
        map_.Build(groups, radius);
        const bool isWhole = PixelIntegrator::Render(pass);
        map_.Clear();
        return isWhole;
    }
    int MaxPassSamples() const override { return 1; }
    SampledSpectrum Li(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler) const override {
        const CameraPathSetup setup{context_, path_, *lights_, lights_->Observer()};
        BsdfDirections bsdf;
        return CameraPath<SurfaceThroughput, BsdfDirections, PhotonGathering>(setup, start, lambda, sampler, bsdf,
                                                                              PhotonGathering(*this))
            .Follow();
    }
    OnlineModel *Model() override { return lights_->Model(); }
    const LightSampler *Lights() const override { return lights_.get(); }
    const LightSampler *EmissionSampler() const override { return shooting_.get(); }

    /// Radius of an iteration (from 0) relative to the first. Its square shrinks by (i + 2/3)/(i + 1) per step, as
    /// stock's does for a constant number of photons per area and iteration.
    static Float RelativeRadius(int iteration) {
        const double i = iteration;
        return Float(std::exp(0.5 * (std::lgamma(i + kKept) - std::lgamma(i + 1) - std::lgamma(kKept))));
    }

  protected:
    /// Photons and camera paths of an iteration share wavelengths and time: photons stay with moving surfaces.
    std::optional<CommonNumbers> Common() const override { return common_; }

  private:
    /// Fraction of photons kept as the radius shrinks (Hachisuka and Jensen 2009, alpha).
    static constexpr double kKept = 2.0 / 3;
    /// Light paths per task.
    static constexpr int64_t kGroup = 4096;

    void TraceLightPath(const SampledWavelengths &shared, uint64_t index, std::vector<Photon> &photons) const {
        const Scene &scene = context_.scene;
        SampledWavelengths lambda = shared;
        // A scrambled Sobol' sequence over all light paths of a batch of iterations.
        const auto number = [&](int dimension) {
            const uint32_t v = SobolBits(SobolMatrices() + dimension * SobolIndexBits, index);
            return SobolToFloat(OwenScramble(v, Hash(seed_, dimension)));
        };
        Rng rng(Hash(seed_, index));
        const Float time = Lerp(common_.time, context_.camera.ShutterOpen(), context_.camera.ShutterClose());
        const std::optional<SampledLight> chosen = shooting_->Sample({.time = time}, number(0));
        if (!chosen || !(chosen->pmf > 0)) return;
        const LightComponent light = scene.Lights()[chosen->light];
        const std::optional<LightLeSample> left =
            light.SampleLe({number(1), number(2)}, {number(3), number(4)}, lambda);
        if (!left) return;
        SampledSpectrum beta = left->L / (chosen->pmf * left->pdfPosition * left->pdfDirection);
        if (left->n != Normal3(0)) beta *= AbsDot(left->n, left->ray.d);
        Ray ray = left->ray;
        ray.time = time;
        ray.medium = scene.MediumOfLight(chosen->light, left->n, left->ray.d);
        PathWalk walk(context_, ray);
        for (int scatterings = 0; beta && walk.NextSurface(lambda);) {
            const auto &[point, bsdf] = walk.Vertex();
            // Light at its first surface is covered by the camera paths' direct lighting.
            const Float cosine = AbsDot(point.wo, point.n);
            if (scatterings > 0 && cosine > 0) {
                const Float ratio = AbsDot(point.wo, point.shading.n) / cosine;
                photons.push_back({point.p, point.wo, beta * ratio, scatterings, lambda.SecondaryTerminated()});
            }
            if (++scatterings == settings_.maxDepth) break;
            const Float uComponent = rng.Uniform();
            const std::optional<BsdfSample> sample =
                bsdf.Sample(point.wo, uComponent, rng.Uniform2(), TransportMode::Importance);
            if (!sample) break;
            SampledSpectrum next = beta * sample->f * (AdjointCosine(point, point.wo, sample->wi) / sample->pdf);
            // Russian roulette that keeps the power of all photons about equal.
            if (EndsByRoulette(next.MaxComponent() / beta.MaxComponent(), rng, next)) break;
            beta = next;
            walk.Scatter(*sample);
        }
    }
    /// Returns the radiance scattered from photons of all wavelengths. Adds that from photons of one colour to `first`.
    SampledSpectrum IndirectFromPhotons(const PathVertex &vertex, const SampledSpectrum &beta, int scatterings,
                                        Float &first) const {
        const auto &[point, bsdf] = vertex;
        SampledSpectrum all(0), ofOneColour(0);
        map_.ForEachAround(point.p, [&](const Photon &photon) {
            if (photon.scatterings + scatterings <= settings_.maxDepth)
                (photon.isOneColour ? ofOneColour : all) += bsdf.F(point.wo, photon.wi) * photon.power;
        });
        first += beta[0] * ofOneColour[0] * perArea_;
        return beta * (all * perArea_);
    }

    /// Policy of camera paths: at surfaces with a diffuse lobe, photons provide all scattered light except the emission
    /// hit by the next ray.
    class PhotonGathering {
      public:
        explicit PhotonGathering(const SppmIntegrator &integrator) : integrator_(integrator) {}
        bool IsLastRay() const { return isLastRay_; }
        bool GathersAt(const PathVertex &vertex) const { return Has(vertex.bsdf.Flags(), BxdfFlags::Diffuse); }
        SampledSpectrum At(const PathVertex &vertex, const SampledSpectrum &beta, int depth) {
            return integrator_.IndirectFromPhotons(vertex, beta, depth, first_);
        }
        void Leave(const PathVertex &vertex, const BsdfSample &sample) {
            if (!IsSpecular(sample.flags)) isLastRay_ = GathersAt(vertex);
        }
        /// Termination, which may follow the gathering, divides the density of the first wavelength by their number.
        void End(SampledSpectrum &L, const SampledWavelengths &lambda) const {
            L[0] += lambda.SecondaryTerminated() ? first_ : first_ * Float(SpectrumSamples);
        }

      private:
        const SppmIntegrator &integrator_;
        bool isLastRay_ = false;
        Float first_ = 0;  ///< radiance at the first wavelength, of photons that have no other
    };

    PathContext context_;
    SppmSettings settings_;
    PathSettings path_;  ///< of camera paths
    std::unique_ptr<LightSampler> lights_, shooting_;
    // Of the current iteration.
    PhotonMap map_;
    CommonNumbers common_;
    Float perArea_ = 0;
    uint64_t seed_ = 0;
};

}  // namespace pbrt
