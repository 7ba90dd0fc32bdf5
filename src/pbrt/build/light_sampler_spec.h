#pragma once
#include <optional>
#include <string>

#include "pbrt/integrators/registry.h"

namespace pbrt {

struct LightSamplerSpec {
    const LightSamplerRegistry::Entry *entry = nullptr;
    bool meshLights = false;
    ParamSet params;  ///< "name.key" parameters only
    /// "octree", or "bvh+meshlights".
    std::string Label() const { return meshLights ? entry->name + "+meshlights" : entry->name; }
    std::unique_ptr<LightSampler> Make(const PluginRegistry &registry, const LightTable &lights) const {
        return registry.Make(*entry, lights, params, meshLights);
    }
};

inline constexpr const char *kLightChoiceSyntax = "name[:key=value,...][+mesh][+guide[:key=value,...]]";
/// `choice` (kLightChoiceSyntax) without "+mesh".
std::string WithoutMesh(std::string choice);

/// Light selection flags; empty if not given. All programs share the syntax kLightChoiceSyntax.
struct LightFlags {
    std::string choice;
    bool meshLights = false;                    ///< as "+mesh"
    const char *choiceFlag = "--lightsampler";  ///< for messages
};

struct LightSelectionParams {
    std::string lightSampler = "bvh";
    bool meshLights = false;
    void Describe(auto &&v) {
        v("lightsampler", lightSampler, "light sampler of shadow rays; --lightsampler overrides it");
        v("meshlights", meshLights, "select emissive meshes as one light");
    }
};

/// Declares the "name.key" parameters of all light samplers, so that a flag can select any of them. `isGuided`: also
/// those of direction sampling.
void DeclareLightParams(ParamReader &reader, const PluginRegistry &registry, bool isGuided);

struct LightSelection {
    LightSamplerSpec sampler;
    /// "+guide": guided paths, with these "guide.key" parameters in addition to the integrator's.
    std::optional<ParamSet> guide;
};

struct DirectionSpec {
    const DirectionSamplings::Entry *entry = nullptr;
    ParamSet params;
};
/// Merges the integrator's "guide.key" parameters with `added` (LightSelection::guide). Errors go to the sink.
DirectionSpec ReadDirections(const ParamSet &integrator, const std::optional<ParamSet> &added,
                             const PluginRegistry &registry, DiagnosticSink &sink);

/// Parses `"string lightsampler"`, `"bool meshlights"` and the `name.key` parameters of an integrator, and the
/// overriding flags: a name replaces the scene's, keys are added to the scene's keys for the same sampler. Errors
/// (unknown names or keys, invalid values) go to the sink with location, and the result is empty; parameters without
/// effect are warnings. `defaults`: the integrator's.
std::optional<LightSelection> ReadLightSelection(const ParamSet &integrator, const LightFlags &flags,
                                                 const PluginRegistry &registry, DiagnosticSink &sink,
                                                 const LightSelectionParams &defaults = {});

/// Parses the sampler for light path emission: the integrator's `"string shootingsampler"`, or the overriding flag
/// --shooting-sampler, `name[:key=value,...]` or empty. Its keys are those of the same light sampler.
/// Position-dependent samplers are an error; errors go to the sink.
std::optional<LightSamplerSpec> ReadShootingSampler(const ParamSet &integrator, const std::string &named,
                                                    const std::string &flag, const PluginRegistry &registry,
                                                    DiagnosticSink &sink);

}  // namespace pbrt
