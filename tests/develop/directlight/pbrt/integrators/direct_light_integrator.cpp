#include "pbrt/integrators/direct_light_integrator.h"

#include "pbrt/transport/direct_light.h"

namespace pbrt {

DirectLightIntegrator::DirectLightIntegrator(const PathContext &context, int shadowRays,
                                             std::unique_ptr<LightSampler> lights)
    : context_(context), shadowRays_(shadowRays), lights_(std::move(lights)) {}

SampledSpectrum DirectLightIntegrator::Li(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler) const {
    PathWalk walk(context_, start.ray, start.visible);
    ++ThreadCounters().cameraPaths;
    do {
        if (walk.Next() != PathWalk::Met::Surface) return SampledSpectrum(0);
    } while (!walk.FindScattering(lambda));
    ++ThreadCounters().pathVertices;

    VertexSelection selection;
    selection.Prepare(*lights_, walk.Vertex(), lambda, 1);
    ObservedPath unobserved;
    SampledSpectrum L(0);
    for (int i = 0; i < shadowRays_; ++i) {
        const Float uLight = sampler.Get1D();
        const std::optional<DirectLight> light =
            SampleDirectLight(context_.scene, walk.Vertex(), selection.lights, lambda, false, uLight, sampler.Get2D(),
                              unobserved, [&](const LightLiSample &to, const Point2 &) {
                                  return TraceShadowRay(context_.scene, selection.from, to);
                              });
        if (light) L += light->F() * light->sample.L / light->Pdf();
    }
    return L / Float(shadowRays_);
}

}  // namespace pbrt
