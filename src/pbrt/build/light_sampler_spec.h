#pragma once
#include <memory>
#include <optional>
#include <string>

#include "pbrt/integrators/registry.h"

namespace pbrt {

/// A light sampler chosen by name, with its parameters.
struct LightSamplerSpec {
    const LightSamplerRegistry::Entry *entry = nullptr;
    bool meshLights = false;
    ParamSet params;  ///< "name.key" parameters only
    /// "octree", or "bvh+meshlights".
    std::string Label() const { return meshLights ? entry->name + "+meshlights" : entry->name; }
};

inline constexpr const char *kLightChoiceSyntax = "name[:key=value,...][+mesh][+guide[:key=value,...]]";

/// The flags for light selection; empty if not given. All programs use the same syntax for a choice:
/// kLightChoiceSyntax.
struct LightFlags {
    std::string choice;
    bool meshLights = false;                    ///< as "+mesh"
    const char *choiceFlag = "--lightsampler";  ///< for messages
};

/// The parts of a choice, without the words "mesh" and "guide".
struct LightChoiceText {
    std::string sampler;
    bool mesh = false;
    std::optional<std::string> guide;
};
/// Throws UserError, at the flag, where something else follows a "+". Names and parameters are not checked.
LightChoiceText SplitLightChoice(const std::string &choice, const char *flag);

/// The parameters of an integrator that choose the light sampler.
struct LightSelectionParams {
    std::string lightSampler = "bvh";
    bool meshLights = false;
    template <class V>
    void Describe(V &&v) {
        v("lightsampler", lightSampler,
          "the light sampler, which chooses the light for each shadow ray; --lightsampler overrides it");
        v("meshlights", meshLights, "an emissive mesh is one light for selection");
    }
};

/// Declares the "name.key" parameters of all light samplers, chosen or not, so that a flag can choose another one.
/// `isGuided`: and those of direction sampling.
void DeclareLightParams(ParamReader &reader, const PluginRegistry &registry, bool isGuided);

struct LightSelection {
    LightSamplerSpec sampler;
    /// "+guide": paths are guided, with these "guide.key" parameters on top of the integrator's.
    std::optional<ParamSet> guide;
};

/// What chooses directions of paths, with its parameters.
struct DirectionSpec {
    const DirectionSamplings::Entry *entry = nullptr;
    ParamSet params;
};
/// The integrator's "guide.key" parameters and those of `added` (LightSelection::guide). Errors go to the sink.
DirectionSpec ReadDirections(const ParamSet &integrator, const std::optional<ParamSet> &added,
                             const PluginRegistry &registry, DiagnosticSink &sink);

/// Reads `"string lightsampler"`, `"bool meshlights"` and the `name.key` parameters of an integrator, and the flags,
/// which override the scene: a name replaces the scene's, keys are added to the scene's keys for the same sampler.
/// Unknown names and keys, unreadable values and values out of range go to the sink as errors at
/// their place (nothing is returned then), parameters that have no effect as warnings. `defaults`: for what the
/// integrator leaves out.
std::optional<LightSelection> ReadLightSelection(const ParamSet &integrator, const LightFlags &flags,
                                                 const PluginRegistry &registry, DiagnosticSink &sink,
                                                 const LightSelectionParams &defaults = {});

/// Reads the sampler that chooses where light paths begin: the integrator's `"string shootingsampler"`, whose value is
/// given, or the flag --shooting-sampler, `name[:key=value,...]` or empty, which overrides it. Its keys are those of
/// the same light sampler. A sampler whose probabilities differ from place to place is an error, and errors go to the
/// sink.
std::optional<LightSamplerSpec> ReadShootingSampler(const ParamSet &integrator, const std::string &named,
                                                    const std::string &flag, const PluginRegistry &registry,
                                                    DiagnosticSink &sink);

/// ReadLightSelection for a choice alone, without a scene. Throws UserError.
LightSelection ReadLightSelection(const std::string &choice, const PluginRegistry &registry);

}  // namespace pbrt
