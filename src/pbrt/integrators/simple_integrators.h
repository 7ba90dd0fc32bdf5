#pragma once
#include "pbrt/bxdfs/bsdf.h"
#include "pbrt/core/counters.h"
#include "pbrt/core/error.h"
#include "pbrt/integrators/pixel_integrator.h"
#include "pbrt/lightsamplers/simple_light_samplers.h"
#include "pbrt/math/warps.h"
#include "pbrt/spectra/color_space.h"
#include "pbrt/transport/direct_light.h"
#include "pbrt/transport/medium_track.h"

namespace pbrt {

namespace detail {

/// Radiance emitted towards the walk at its last hit.
inline SampledSpectrum Arriving(const PathWalk &walk, const SampledWavelengths &lambda) {
    SampledSpectrum sum(0);
    walk.ForEachEmission(lambda,
                         [&](const SampledSpectrum &Le, LightId, const Point3 &, const Normal3 &) { sum += Le; });
    return sum;
}

struct Direction {
    Vector3 wi{};
    Float pdf = 0;  ///< solid angle
};

/// Samples uniformly where a vertex can scatter: the half-space on the viewer's side, the one behind, or both.
inline Direction SampleEvenly(const PathVertex &vertex, const Point2 &u) {
    const auto &[point, bsdf] = vertex;
    const BxdfFlags flags = bsdf.Flags();
    const bool reflects = IsReflective(flags);
    if (reflects && IsTransmissive(flags)) return {SampleUniformSphere(u), UniformSpherePdf()};
    const Vector3 aroundNormal = Frame::FromZ(point.n).FromLocal(SampleUniformHemisphere(u));
    const bool viewerSide = (Dot(point.wo, point.n) > 0) == (Dot(aroundNormal, point.n) > 0);
    return {viewerSide == reflects ? aroundNormal : -aroundNormal, UniformHemispherePdf()};
}

/// Throughput of scattering into a direction not sampled from the BSDF.
inline SampledSpectrum Throughput(const PathVertex &vertex, const Direction &to) {
    const auto &[point, bsdf] = vertex;
    return bsdf.F(point.wo, to.wi) * (AbsDot(to.wi, point.shading.n) / to.pdf);
}

}  // namespace detail

/// Path tracing without MIS, with optional light sampling (uniform over the lights) and BSDF sampling.
class SimplePathIntegrator final : public PixelIntegrator {
  public:
    SimplePathIntegrator(const PathContext &context, int maxDepth, bool sampleLights, bool sampleBsdf)
        : context_(context), maxDepth_(maxDepth), sampleLights_(sampleLights), sampleBsdf_(sampleBsdf),
          lights_(std::make_unique<UniformLightSampler>(context.scene.Lights().ByComponent())) {}
    SampledSpectrum Li(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler) const override {
        PathWalk walk(context_, start.ray, start.visible);
        SampledSpectrum L(0), beta(1);
        ++ThreadCounters().cameraPaths;
        // Without MIS, every light path must be sampled by one technique only: where lights are sampled, emission hit
        // counts only if light sampling cannot reach it.
        bool foundBySampling = false;
        for (int depth = 0; beta; ++depth) {
            const PathWalk::Met met = walk.Next();
            if (met == PathWalk::Met::TooManyInterfaces) break;
            if (!foundBySampling) L += beta * detail::Arriving(walk, lambda);
            if (met == PathWalk::Met::Nothing) break;
            if (depth == maxDepth_) {
                walk.End(lambda);
                break;
            }
            foundBySampling = false;
            if (!walk.FindScattering(lambda)) continue;
            ++ThreadCounters().pathVertices;
            const auto &[point, bsdf] = walk.Vertex();
            if (sampleLights_) L += SampleDirect(walk.Vertex(), beta, lambda, depth + 1, sampler);
            if (sampleBsdf_) {
                const Float uComponent = sampler.Get1D();
                const std::optional<BsdfSample> sample = bsdf.Sample(point.wo, uComponent, sampler.Get2D());
                if (!sample) break;
                beta *= sample->f * (AbsDot(sample->wi, point.shading.n) / sample->pdf);
                foundBySampling = sampleLights_ && !IsSpecular(sample->flags);
                walk.Scatter(*sample);
            } else {
                const detail::Direction to = detail::SampleEvenly(walk.Vertex(), sampler.Get2D());
                beta *= detail::Throughput(walk.Vertex(), to);
                foundBySampling = sampleLights_;
                walk.Leave(to.wi);
            }
        }
        return L;
    }

  private:
    /// Direct light from one point on one light, without MIS weight, times the path's throughput.
    SampledSpectrum SampleDirect(const PathVertex &vertex, const SampledSpectrum &beta,
                                 const SampledWavelengths &lambda, int depth, Sampler &sampler) const {
        VertexSelection selection;
        selection.Prepare(*lights_, vertex, lambda, depth);
        const Float uLight = sampler.Get1D();
        ObservedPath unobserved;
        const std::optional<DirectLight> light =
            SampleDirectLight(context_.scene, vertex, selection.lights, lambda, false, uLight, sampler.Get2D(),
                              unobserved, [&](const LightLiSample &to, const Point2 &) {
                                  return TraceShadowRay(context_.scene, selection.from, to);
                              });
        return light ? beta * light->F() * light->sample.L / light->Pdf() : SampledSpectrum(0);
    }
    PathContext context_;
    int maxDepth_;
    bool sampleLights_, sampleBsdf_;
    std::unique_ptr<LightSampler> lights_;
};

/// Scatters into uniform directions and adds emission: slow, but simple enough to validate the others.
class RandomWalkIntegrator final : public PixelIntegrator {
  public:
    RandomWalkIntegrator(const PathContext &context, int maxDepth) : context_(context), maxDepth_(maxDepth) {}
    SampledSpectrum Li(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler) const override {
        PathWalk walk(context_, start.ray, start.visible);
        SampledSpectrum L(0), beta(1);
        ++ThreadCounters().cameraPaths;
        for (int depth = 0; beta;) {
            const PathWalk::Met met = walk.Next();
            if (met == PathWalk::Met::TooManyInterfaces) break;
            L += beta * detail::Arriving(walk, lambda);
            if (met == PathWalk::Met::Nothing) break;
            if (depth == maxDepth_) {
                walk.End(lambda);
                break;
            }
            if (!walk.FindScattering(lambda)) continue;
            ++depth;
            ++ThreadCounters().pathVertices;
            const detail::Direction to{SampleUniformSphere(sampler.Get2D()), UniformSpherePdf()};
            beta *= detail::Throughput(walk.Vertex(), to);
            walk.Leave(to.wi);
        }
        return L;
    }

  private:
    PathContext context_;
    int maxDepth_;
};

/// Single-wavelength path tracing through media and interfaces without light sampling, to validate the others.
/// Scattering surfaces end a path, as in stock pbrt-v4.
class SimpleVolPathIntegrator final : public PixelIntegrator {
  public:
    SimpleVolPathIntegrator(const PathContext &context, int maxDepth) : context_(context), maxDepth_(maxDepth) {}
    SampledSpectrum Li(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler) const override {
        lambda.TerminateSecondary();
        PathWalk walk(context_, start.ray, start.visible);
        SpectralWeights weights;
        weights.onlyFirst = true;
        SampledSpectrum L(0);
        ++ThreadCounters().cameraPaths;
        const auto track = [&] {
            return walk.ThroughMedium(lambda, sampler, true, weights,
                                      [&](const SampledSpectrum &radiance, Float) { L += radiance; });
        };
        const auto arrive = [&](PathWalk::Met) {
            walk.ForEachEmission(lambda, [&](const SampledSpectrum &Le, LightId, const Point3 &, const Normal3 &) {
                L += weights.beta * Le;
            });
        };
        for (int depth = 0;; ++depth) {
            const std::optional<ReachedVertex> reached = walk.NextVertex(lambda, weights, track, arrive);
            if (!reached) return L;
            if (!reached->phase) break;
            if (depth == maxDepth_) return L;
            ++ThreadCounters().pathVertices;
            walk.ScatterInMedium(reached->p, reached->phase->SampleP(-walk.GetRay().d, sampler.Get2D()).wi);
        }
        const auto &[point, bsdf] = walk.Vertex();
        const Float uComponent = sampler.Get1D();
        if (bsdf.Sample(point.wo, uComponent, sampler.Get2D()))
            throw UserError(
                "Integrator \"simplevolpath\" follows light through media only, and a path has met a surface "
                "that scatters; \"volpath\" renders such scenes.");
        return L;
    }

  private:
    PathContext context_;
    int maxDepth_;
};

/// Cosine-weighted unoccluded fraction of the hemisphere up to maxDistance, times a unit illuminant.
class AmbientOcclusionIntegrator final : public PixelIntegrator {
  public:
    AmbientOcclusionIntegrator(const PathContext &context, bool cosineSample, Float maxDistance,
                               const ColorSpace &space)
        : context_(context), cosineSample_(cosineSample), maxDistance_(maxDistance), illuminant_(space.IlluminantPtr()),
          scale_(1 / SpectrumToPhotometric(*illuminant_)) {}
    SampledSpectrum Li(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler) const override {
        PathWalk walk(context_, start.ray, start.visible);
        ++ThreadCounters().cameraPaths;
        if (!walk.NextSurface(lambda)) return SampledSpectrum(0);
        const SurfacePoint &point = walk.Vertex().point;
        const Normal3 n = FaceForward(point.n, point.wo);
        const Point2 u = sampler.Get2D();
        const Vector3 local = cosineSample_ ? SampleCosineHemisphere(u) : SampleUniformHemisphere(u);
        const Float pdf = cosineSample_ ? CosineHemispherePdf(local.z) : UniformHemispherePdf();  // solid angle
        if (!(pdf > 0)) return SampledSpectrum(0);
        Ray ray = point.SpawnRay(Frame::FromZ(n).FromLocal(local));
        ray.tMax = maxDistance_;
        if (context_.scene.Occluded(ray)) return SampledSpectrum(0);
        return illuminant_->Sample(lambda) * (scale_ * local.z * InvPi / pdf);
    }

  private:
    PathContext context_;
    bool cosineSample_;
    Float maxDistance_;
    SpectrumPtr illuminant_;
    Float scale_;
};

}  // namespace pbrt
