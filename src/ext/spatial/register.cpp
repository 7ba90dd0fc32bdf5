#include "ext/spatial/spatial_light_sampler.h"
#include "pbrt/lightsamplers/registry.h"

void register_spatial(pbrt::LightSamplerRegistry &registry) {
    using namespace ext;
    LightSamplerRegistry::Entry entry;
    entry.name = "spatial";
    entry.summary = "unshadowed contribution per voxel, as pbrt-v3 (Noh, Choi, Moon 2023, Eq. 3)";
    entry.params = DocumentParams<SpatialParams>();
    entry.check = ParamsCheck<SpatialParams>("spatial");
    entry.make = [](const LightGroups &groups, const ParamSet &params) -> std::unique_ptr<LightSampler> {
        SpatialParams p;
        ReadParams(p, params, "spatial");
        return std::make_unique<SpatialLightSampler>(groups.Lights(), p);
    };
    registry.Add(std::move(entry));
}
