#include "pbrt/build/integrator_builder.h"
#include "pbrt/integrators/direct_light_integrator.h"

namespace pbrt {
namespace {

struct DirectLightParams {
    int shadowRays = 1;
    LightSelectionParams lights;
    template <class V>
    void Describe(V &&v) {
        v("shadowrays", shadowRays, Range<int>{1, 1024}, "shadow rays per camera ray");
        lights.Describe(v);
    }
};

IntegratorSettings MakeDirectLight(const DirectLightParams &p, const ParamSet &set, const IntegratorReading &r) {
    IntegratorSettings settings;
    settings.maxDepth = 1;
    settings.lights = ReadLights(set, r);
    if (!settings.lights) return settings;  // the sink has the errors
    settings.make = [rays = p.shadowRays, &registry = r.registry, lights = settings.lights->sampler](
                        const PathContext &context, const ColorSpace &) -> std::unique_ptr<Integrator> {
        return std::make_unique<DirectLightIntegrator>(context, rays, lights.Make(registry, context.scene.Lights()));
    };
    return settings;
}

}  // namespace

void AddDirectLight(IntegratorTable &table) {
    table.Add<DirectLightParams>("directlight", "direct light on the surfaces that the camera sees", &MakeDirectLight,
                                 {.hasLightSampler = true});
}

}  // namespace pbrt
