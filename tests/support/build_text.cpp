#include "support/build_text.h"

#include "pbrt/build/light_sampler_spec.h"
#include "pbrt/scenefile/parser.h"
#include "plugins.h"
#include "support/parse_text.h"

namespace pbrt::test {

namespace {
BuiltScene Build(SceneDescription description, DiagnosticSink &sink, const BuildOptions &options) {
    sink.ThrowIfErrors();
    Progress progress;
    return BuildScene(description, options, AllSamplers(), sink, progress);
}
}  // namespace

const PluginRegistry &AllSamplers() {
    static const PluginRegistry registry = [] {
        PluginRegistry r;
        RegisterPlugins(r);
        return r;
    }();
    return registry;
}

std::unique_ptr<LightSampler> MakeLightSampler(const std::string &choice, const LightTable &lights,
                                               const PluginRegistry &registry) {
    DiagnosticSink sink;
    LightFlags flags;
    flags.choice = choice;
    LightSelectionParams defaults;  // whose name must be in the registry, although `choice` overrides it
    defaults.lightSampler = registry.samplers.Names().front();
    const std::optional<LightSelection> selection = ReadLightSelection(ParamSet(), flags, registry, sink, defaults);
    sink.ThrowIfErrors();
    const LightSamplerSpec &spec = selection->sampler;
    return registry.Make(*spec.entry, lights, spec.params, spec.meshLights);
}

void PrepareIn(const BuiltScene &built, LightSampler &sampler) {
    Progress progress;
    PrepareContext context = built.Preparation(progress);
    sampler.Prepare(context);
}

BuiltScene BuildText(const std::string &text, const BuildOptions &options) {
    DiagnosticSink sink;
    return Build(ParseSceneText(text, sink), sink, options);
}

BuiltScene BuildFile(const std::string &file, const BuildOptions &options) {
    DiagnosticSink sink;
    return Build(ParseSceneFiles({file}, sink), sink, options);
}

}  // namespace pbrt::test
