#include "pbrt/integrators/simple_integrators.h"

#include "pbrt/core/counters.h"
#include "pbrt/integrators/path_common.h"
#include "pbrt/integrators/visible_surface.h"
#include "pbrt/lightsamplers/simple_light_samplers.h"
#include "pbrt/math/warps.h"

namespace pbrt {

namespace {
SampledSpectrum Background(const Scene &scene, const Ray &ray, const SampledWavelengths &lambda) {
    SampledSpectrum L(0);
    for (LightId id : scene.Lights().Infinite()) L += scene.Lights()[id].Le(ray.o, ray.d, lambda);
    return L;
}

/// A direction that did not come from the BSDF, in the form PathRay takes.
BsdfSample UniformSample(const Vector3 &wi, Float pdf) {
    BsdfSample sample;
    sample.wi = wi;
    sample.pdf = pdf;
    sample.flags = BxdfFlags::Glossy;
    return sample;
}

}  // namespace

SimplePathIntegrator::SimplePathIntegrator(const IntegratorContext &context, int maxDepth, bool sampleLights, bool sampleBsdf)
    : context_(context),
      maxDepth_(maxDepth),
      sampleLights_(sampleLights),
      sampleBsdf_(sampleBsdf),
      lights_(std::make_unique<UniformLightSampler>(context.scene.Lights().Candidates())) {}

SampledSpectrum SimplePathIntegrator::Li(CameraRay cameraRay, SampledWavelengths &lambda, Sampler &sampler,
                                         std::optional<VisibleSurface> *visible) const {
    const Scene &scene = context_.scene;
    PathRay path{cameraRay.ray, cameraRay.differential};
    const VisibleSurfaceReport report(context_, cameraRay, visible);
    SampledSpectrum L(0), beta(1);
    bool specular = true;  // emission is counted where light sampling could not have found it
    ++ThreadCounters().cameraPaths;
    for (int depth = 0; beta;) {
        std::optional<SurfacePoint> hit = scene.Intersect(path.ray);
        bool countEmission = !sampleLights_ || specular;
        if (!hit) {
            if (countEmission) L += beta * Background(scene, path.ray, lambda);
            break;
        }
        SurfacePoint &point = *hit;
        if (countEmission) L += beta * EmittedRadiance(scene, point, lambda);
        if (depth++ == maxDepth_) {
            report.LookOn(point, path, lambda);
            break;
        }
        FindFootprint(context_, point, path);
        Bsdf bsdf = ComputeBsdf(scene, point, lambda);
        if (!bsdf) {
            specular = true;
            path.PassThrough(point);
            continue;
        }
        report.See(point, bsdf, path, lambda);
        ++ThreadCounters().pathVertices;
        if (sampleLights_) {
            std::optional<SampledLight> selected = lights_->Sample(LightQueryAt(point, bsdf, lambda, depth), sampler.Get1D());
            Point2 uLight = sampler.Get2D();
            if (selected) {
                std::optional<LightLiSample> ls = scene.Lights()[selected->light].SampleLi(
                    ScatteringContextAt(scene, point, bsdf), uLight, lambda, false);
                if (ls && ls->L && ls->pdf > 0) {
                    SampledSpectrum f = bsdf.F(point.wo, ls->wi) * AbsDot(ls->wi, point.shading.n);
                    if (f && !scene.Occluded(LightContextAt(point), *ls)) L += beta * f * ls->L / (selected->pmf * ls->pdf);
                }
            }
        }
        if (sampleBsdf_) {
            Float uComponent = sampler.Get1D();
            std::optional<BsdfSample> sample = bsdf.Sample(point.wo, uComponent, sampler.Get2D());
            if (!sample) break;
            beta *= sample->f * (AbsDot(sample->wi, point.shading.n) / sample->pdf);
            specular = IsSpecular(sample->flags);
            path.Scatter(point, *sample);
        } else {
            // Uniform over every side the BSDF can send light to.
            Vector3 wi;
            Float pdf;
            BxdfFlags flags = bsdf.Flags();
            if (IsReflective(flags) && IsTransmissive(flags)) {
                wi = SampleUniformSphere(sampler.Get2D());
                pdf = UniformSpherePdf();
            } else {
                wi = SampleUniformHemisphere(sampler.Get2D());
                pdf = UniformHemispherePdf();
                bool wantSameSide = IsReflective(flags);
                wi = Frame::FromZ(point.n).FromLocal(wi);
                bool sameSide = Dot(point.wo, point.n) * Dot(wi, point.n) > 0;
                if (sameSide != wantSameSide) wi = -wi;
            }
            beta *= bsdf.F(point.wo, wi) * (AbsDot(wi, point.shading.n) / pdf);
            specular = false;
            path.Scatter(point, UniformSample(wi, pdf));
        }
    }
    return L;
}

SampledSpectrum RandomWalkIntegrator::Li(CameraRay cameraRay, SampledWavelengths &lambda, Sampler &sampler,
                                         std::optional<VisibleSurface> *visible) const {
    const Scene &scene = context_.scene;
    PathRay path{cameraRay.ray, cameraRay.differential};
    const VisibleSurfaceReport report(context_, cameraRay, visible);
    SampledSpectrum L(0), beta(1);
    ++ThreadCounters().cameraPaths;
    for (int depth = 0; beta;) {
        std::optional<SurfacePoint> hit = scene.Intersect(path.ray);
        if (!hit) {
            L += beta * Background(scene, path.ray, lambda);
            break;
        }
        SurfacePoint &point = *hit;
        L += beta * EmittedRadiance(scene, point, lambda);
        if (depth == maxDepth_) {
            report.LookOn(point, path, lambda);
            break;
        }
        FindFootprint(context_, point, path);
        Bsdf bsdf = ComputeBsdf(scene, point, lambda);
        if (!bsdf) {
            path.PassThrough(point);
            continue;
        }
        ++depth;
        report.See(point, bsdf, path, lambda);
        ++ThreadCounters().pathVertices;
        Vector3 wi = SampleUniformSphere(sampler.Get2D());
        beta *= bsdf.F(point.wo, wi) * (AbsDot(wi, point.shading.n) / UniformSpherePdf());
        path.Scatter(point, UniformSample(wi, UniformSpherePdf()));
    }
    return L;
}

AmbientOcclusionIntegrator::AmbientOcclusionIntegrator(const IntegratorContext &context, bool cosineSample,
                                                       Float maxDistance, const ColorSpace &space)
    : context_(context),
      cosineSample_(cosineSample),
      maxDistance_(maxDistance),
      illuminant_(space.IlluminantPtr()),
      scale_(1 / SpectrumToPhotometric(*illuminant_)) {}

SampledSpectrum AmbientOcclusionIntegrator::Li(CameraRay cameraRay, SampledWavelengths &lambda, Sampler &sampler,
                                               std::optional<VisibleSurface> *visible) const {
    PathRay path{cameraRay.ray, cameraRay.differential};
    const VisibleSurfaceReport report(context_, cameraRay, visible);
    ++ThreadCounters().cameraPaths;
    while (true) {
        std::optional<SurfacePoint> hit = context_.scene.Intersect(path.ray);
        if (!hit) return SampledSpectrum(0);
        SurfacePoint &point = *hit;
        FindFootprint(context_, point, path);
        const Bsdf bsdf = ComputeBsdf(context_.scene, point, lambda);
        if (!bsdf) {
            path.PassThrough(point);
            continue;
        }
        report.See(point, bsdf, path, lambda);
        Normal3 n = FaceForward(point.n, point.wo);
        Point2 u = sampler.Get2D();
        Vector3 local = cosineSample_ ? SampleCosineHemisphere(u) : SampleUniformHemisphere(u);
        Float pdf = cosineSample_ ? CosineHemispherePdf(local.z) : UniformHemispherePdf();  // solid angle
        if (!(pdf > 0)) return SampledSpectrum(0);
        Ray ray = point.SpawnRay(Frame::FromZ(n).FromLocal(local));
        ray.tMax = maxDistance_;
        if (context_.scene.Occluded(ray)) return SampledSpectrum(0);
        return illuminant_->Sample(lambda) * (scale_ * local.z * InvPi / pdf);
    }
}

}  // namespace pbrt
