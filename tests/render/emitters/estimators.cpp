#include "estimators.h"

#include "pbrt/integrators/path_integrator.h"
#include "pbrt/integrators/simple_integrators.h"
#include "pbrt/transport/vertex.h"
#include "support/build_text.h"
#include "support/wrapped_sampler.h"

namespace pbrt::test {

namespace {

/// Direct light by light sampling alone, without lamps that the camera sees.
class LightSamplingOnly final : public PixelIntegrator {
  public:
    LightSamplingOnly(const Scene &scene, std::unique_ptr<LightSampler> lights)
        : scene_(scene), lights_(std::move(lights)) {}
    void Prepare(PrepareContext &context) override { lights_->Prepare(context); }
    SampledSpectrum Li(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler) const override {
        PathVertex vertex;
        auto &[point, bsdf] = vertex;
        if (!scene_.Intersect(start.ray.ray, &point)) return SampledSpectrum(0);
        SampledSpectrum L(0);
        bsdf = ComputeBsdf(scene_, point, lambda);
        Float uSelect = sampler.Get1D();
        Point2 uLight = sampler.Get2D();
        std::optional<SampledLight> light = lights_->Sample(LightQueryAt(vertex, lambda, 1), uSelect);
        if (!light) return L;
        LightSampleContext from = LightContextAt(point);
        std::optional<LightLiSample> s = scene_.Lights()[light->light].SampleLi(from, uLight, lambda, false);
        if (!s || !s->L || !(s->pdf > 0)) return L;
        SampledSpectrum f = bsdf.F(point.wo, s->wi) * AbsDot(s->wi, point.shading.n);
        if (f && !scene_.Occluded(from, *s)) L += f * s->L / (light->pmf * s->pdf);
        return L;
    }

  private:
    const Scene &scene_;
    std::unique_ptr<LightSampler> lights_;
};

/// Black where the camera sees a lamp itself: that is the same to all estimators and hides what they find.
class WithoutSeenLamps final : public PixelIntegrator {
  public:
    WithoutSeenLamps(const Scene &scene, std::unique_ptr<PixelIntegrator> inner)
        : scene_(scene), inner_(std::move(inner)) {}
    void Prepare(PrepareContext &context) override { inner_->Prepare(context); }
    OnlineModel *Model() override { return inner_->Model(); }
    SampledSpectrum Li(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler) const override {
        std::optional<SurfacePoint> point = scene_.Intersect(start.ray.ray);
        if (point && point->light) return SampledSpectrum(0);
        return inner_->Li(start, lambda, sampler);
    }

  private:
    const Scene &scene_;
    std::unique_ptr<PixelIntegrator> inner_;
};

std::unique_ptr<LightSampler> MakeLights(const Scene &scene, const std::string &label, const Spoilt &spoilt) {
    std::unique_ptr<LightSampler> lights = MakeLightSampler(label, scene.Lights());
    if (spoilt.ofSamples == 1 && spoilt.ofRays == 1) return lights;
    const auto times = [](Float factor) {
        return
            [factor](const LightQuery &, const SampledLight &s) { return s.light.value > 0 ? factor * s.pmf : s.pmf; };
    };
    return std::make_unique<TamperedSampler>(std::move(lights), times(spoilt.ofSamples), times(spoilt.ofRays));
}

}  // namespace

PixelStatistics Studio::Render(Estimator estimator, const std::string &lightSampler, int samplesPerPixel, int runs,
                               int firstSeed, const Spoilt &spoilt) const {
    const Scene &scene = *built_.scene;
    const PathContext context{scene, *built_.camera, samplesPerPixel, true};
    PixelStatistics statistics;
    for (int seed = firstSeed; seed < firstSeed + runs; ++seed) {
        std::unique_ptr<PixelIntegrator> integrator;
        if (estimator == Estimator::Bsdf || estimator == Estimator::Lights) {
            integrator =
                std::make_unique<SimplePathIntegrator>(context, built_.maxDepth, estimator == Estimator::Lights, true);
        } else if (estimator == Estimator::Chosen) {
            PBRT_CHECK(built_.maxDepth == 1);
            integrator = std::make_unique<LightSamplingOnly>(scene, MakeLights(scene, lightSampler, spoilt));
        } else {
            integrator = std::make_unique<PathIntegrator>(context, PathSettings{.maxDepth = built_.maxDepth},
                                                          MakeLights(scene, lightSampler, spoilt));
        }
        if (built_.maxDepth == 1) integrator = std::make_unique<WithoutSeenLamps>(scene, std::move(integrator));
        statistics.Add(RenderIndependently(built_, *integrator, samplesPerPixel, seed));
    }
    return statistics;
}

}  // namespace pbrt::test
