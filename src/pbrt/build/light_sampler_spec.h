#pragma once
#include <functional>
#include <memory>
#include <string>

#include "pbrt/lightsamplers/registry.h"

namespace pbrt {

/// A light sampler chosen by name, with its parameters.
struct LightSamplerSpec {
    const LightSamplerRegistry::Entry *entry = nullptr;
    bool meshLights = false;
    ParamSet params;  ///< "name.key" parameters only
    /// "octree", or "bvh+meshlights".
    std::string Label() const { return meshLights ? entry->name + "+meshlights" : entry->name; }
};

/// A shadow-ray gate chosen by name, with its parameters; none by default.
struct ShadowGateSpec {
    const LightSamplerRegistry::GateEntry *entry = nullptr;
    ParamSet params;
};

/// Reads `"string lightsampler"`, `"bool meshlights"` and `name.key` parameters of an integrator. `commandLine` is
/// "name[:key=value,...]" or empty; it beats the scene: its name replaces the scene's, its keys are added to the scene's
/// keys for the same sampler. Unknown names, keys and unreadable values: UserError, at `flag`.
LightSamplerSpec ReadLightSamplerSpec(const ParamSet &integrator, const std::string &commandLine, bool meshLightsFlag,
                                      const LightSamplerRegistry &registry, const char *flag = "--lightsampler");

/// The same for `"string shadowgate"`; "none" is no gate.
ShadowGateSpec ReadShadowGateSpec(const ParamSet &integrator, const std::string &commandLine,
                                  const LightSamplerRegistry &registry, const char *flag = "--shadow-gate");

}  // namespace pbrt
