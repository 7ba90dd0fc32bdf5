#include "support/build_text.h"

#include "pbrt/scenefile/parser.h"
#include "plugins.h"

namespace pbrt::test {

namespace {
BuiltScene Build(SceneDescription description, DiagnosticSink &sink, const BuildOptions &options) {
    sink.ThrowIfErrors();
    LightSamplerRegistry registry;
    RegisterPlugins(registry);
    Progress progress;
    return BuildScene(description, options, registry, sink, progress);
}
}  // namespace

BuiltScene BuildText(const std::string &text, const BuildOptions &options) {
    DiagnosticSink sink;
    return Build(ParseSceneText(text, sink), sink, options);
}

BuiltScene BuildFile(const std::string &file, const BuildOptions &options) {
    DiagnosticSink sink;
    return Build(ParseSceneFiles({file}, sink), sink, options);
}

}  // namespace pbrt::test
