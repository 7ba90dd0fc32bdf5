#include "support/build_text.h"

#include "pbrt/scenefile/parser.h"
#include "plugins.h"

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

BuiltScene BuildText(const std::string &text, const BuildOptions &options) {
    DiagnosticSink sink;
    return Build(ParseSceneText(text, sink), sink, options);
}

BuiltScene BuildFile(const std::string &file, const BuildOptions &options) {
    DiagnosticSink sink;
    return Build(ParseSceneFiles({file}, sink), sink, options);
}

}  // namespace pbrt::test
