#include "ext/baselines/neepp/neepp_light_sampler.h"
#include "pbrt/integrators/registry.h"

void register_neepp(pbrt::PluginRegistry &registry) {
    using namespace ext;
    registry.samplers.Add<NeeppParams>(
        "neepp", "visibility between voxels (NEE++, Guo et al. 2020); neither power nor distance counts",
        [](const NeeppParams &p, const ParamSet &, const LightGroups &groups) {
            return std::make_unique<NeeppLightSampler>(groups.Lights(), p);
        });
}
