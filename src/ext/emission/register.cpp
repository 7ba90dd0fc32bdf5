#include "ext/emission/seen_light_sampler.h"
#include "pbrt/integrators/registry.h"

void register_seen(pbrt::PluginRegistry &registry) {
    using namespace ext;
    registry.samplers.Add<SeenParams>(
        "seen",
        "one table for all places: by power and by how much of the picture's light a short prepass found from each "
        "light; made to begin light paths (`shootingsampler`)",
        [](const SeenParams &p, const ParamSet &, const LightGroups &groups) {
            return std::make_unique<SeenLightSampler>(groups.Lights(), p);
        },
        {.isSameEverywhere = true});
}
