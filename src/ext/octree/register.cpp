#include "ext/octree/paper_octree_light_sampler.h"
#include "ext/octree/visibility_octree_light_sampler.h"
#include "pbrt/integrators/registry.h"

void register_octree(pbrt::PluginRegistry &registry) {
    using namespace ext;
    registry.samplers.Add<OctreeParams>(
        "octree", "Selects lights by visibility learned in a prepass (after Noh, Choi, Moon 2023).",
        [](const OctreeParams &p, const ParamSet &, const LightGroups &groups) -> std::unique_ptr<LightSampler> {
            if (p.model == "paper") return std::make_unique<PaperOctreeLightSampler>(groups.Lights(), p);
            return std::make_unique<VisibilityOctreeLightSampler>(groups.Lights(), p);
        },
        {.example = "budget=0.02,floor=0.1"});
}
