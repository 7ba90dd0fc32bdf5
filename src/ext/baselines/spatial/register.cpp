#include "ext/baselines/spatial/spatial_light_sampler.h"
#include "pbrt/integrators/registry.h"

void register_spatial(pbrt::PluginRegistry &registry) {
    using namespace ext;
    registry.samplers.Add<SpatialParams>("spatial",
                                         "unshadowed contribution per voxel, as pbrt-v3 (Noh, Choi, Moon 2023, Eq. 3)",
                                         [](const SpatialParams &p, const ParamSet &, const LightGroups &groups) {
                                             return std::make_unique<SpatialLightSampler>(groups.Lights(), p);
                                         });
}
