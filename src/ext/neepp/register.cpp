#include "ext/neepp/neepp_gate.h"
#include "ext/neepp/neepp_light_sampler.h"
#include "pbrt/lightsamplers/registry.h"

void register_neepp(pbrt::LightSamplerRegistry &registry) {
    using namespace ext;
    LightSamplerRegistry::Entry entry;
    entry.name = "neepp";
    entry.summary = "visibility between voxels (NEE++, Guo et al. 2020); neither power nor distance counts";
    entry.params = DocumentParams<NeeppParams>();
    entry.check = ParamsCheck<NeeppParams>("neepp");
    entry.make = [](const LightGroups &groups, const ParamSet &params) -> std::unique_ptr<LightSampler> {
        NeeppParams p;
        ReadParams(p, params, "neepp");
        return std::make_unique<NeeppLightSampler>(groups.Lights(), p);
    };
    registry.Add(std::move(entry));

    LightSamplerRegistry::GateEntry gate;
    gate.name = "neepp";
    gate.summary = "skips shadow rays between voxels that do not see each other (NEE++, Guo et al. 2020)";
    gate.params = DocumentParams<NeeppGateParams>();
    gate.check = ParamsCheck<NeeppGateParams>("neepp");
    gate.make = [](const LightTable &lights, const ParamSet &params) -> std::unique_ptr<ShadowRayGate> {
        NeeppGateParams p;
        ReadParams(p, params, "neepp");
        return std::make_unique<NeeppGate>(lights, p);
    };
    registry.AddGate(std::move(gate));
}
