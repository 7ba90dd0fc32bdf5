#include "ext/baselines/oracle/oracle_light_sampler.h"
#include "pbrt/integrators/registry.h"

void register_oracle(pbrt::PluginRegistry &registry) {
    using namespace ext;
    registry.samplers.Add<OracleParams>(
        "oracle",
        "measuring instrument, slow: traces shadow rays to every light at every point for the choice of least variance",
        [](const OracleParams &p, const ParamSet &, const LightGroups &groups) {
            return std::make_unique<OracleLightSampler>(groups.Lights(), p);
        });
}
