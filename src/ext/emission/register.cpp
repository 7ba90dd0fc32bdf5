#include "ext/emission/image_contribution_light_sampler.h"
#include "pbrt/integrators/registry.h"

void register_seen(pbrt::PluginRegistry &registry) {
    using namespace ext;
    registry.samplers.Add<ImageContributionParams>(
        "seen",
        "Chooses lights by power and by their contribution to the image, from a prepass; for `shootingsampler`.",
        [](const ImageContributionParams &p, const ParamSet &, const LightGroups &groups) {
            return std::make_unique<ImageContributionLightSampler>(groups.Lights(), p);
        },
        {.isSameEverywhere = true});
}
