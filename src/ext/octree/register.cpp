#include "ext/octree/paper_octree_light_sampler.h"
#include "ext/octree/visibility_octree_light_sampler.h"
#include "pbrt/lightsamplers/registry.h"

void register_octree(pbrt::LightSamplerRegistry &registry) {
    using namespace ext;
    LightSamplerRegistry::Entry entry;
    entry.name = "octree";
    entry.summary = "Learns in a prepass which lights each region sees (after Noh, Choi, Moon 2023).";
    entry.params = DocumentParams<OctreeParams>();
    entry.check = ParamsCheck<OctreeParams>("octree");
    entry.make = [](const LightGroups &groups, const ParamSet &params) -> std::unique_ptr<LightSampler> {
        OctreeParams p;
        ReadParams(p, params, "octree");
        if (p.model == "paper") return std::make_unique<PaperOctreeLightSampler>(groups.Lights(), p);
        return std::make_unique<VisibilityOctreeLightSampler>(groups.Lights(), p);
    };
    registry.Add(std::move(entry));
}
