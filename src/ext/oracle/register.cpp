#include "ext/oracle/oracle_light_sampler.h"
#include "pbrt/lightsamplers/registry.h"

void register_oracle(pbrt::LightSamplerRegistry &registry) {
    using namespace ext;
    LightSamplerRegistry::Entry entry;
    entry.name = "oracle";
    entry.summary =
        "measuring instrument, slow: shadow rays to every light at every point give the least noisy choice there is";
    entry.params = DocumentParams<OracleParams>();
    entry.check = ParamsCheck<OracleParams>("oracle");
    entry.make = [](const LightGroups &groups, const ParamSet &params) -> std::unique_ptr<LightSampler> {
        OracleParams p;
        ReadParams(p, params, "oracle");
        return std::make_unique<OracleLightSampler>(groups.Lights(), p);
    };
    registry.Add(std::move(entry));
}
