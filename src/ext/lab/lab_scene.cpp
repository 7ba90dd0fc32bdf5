#include "ext/lab/lab_scene.h"

#include "pbrt/core/log.h"
#include "pbrt/scenefile/content_hash.h"
#include "pbrt/scenefile/parser.h"

namespace ext::lab {

std::unique_ptr<Integrator> LabScene::MakeIntegrator(const SamplerChoice &choice, std::optional<int> maxDepth) const {
    LightChoice light;
    light.lightSampler = choice.lightSampler;
    light.meshLights = choice.meshLights;
    light.maxDepth = maxDepth;
    return pbrt::MakeIntegrator(built, light).integrator;
}

void CheckSamplesLights(const BuiltScene &built, const std::string &scene) {
    if (built.lightSamplerName.empty())
        throw UserError(
            fmt::format("{}: the integrator \"{}\" uses no light sampler; \"path\", \"volpath\", \"bdpt\", "
                        "\"mlt\" and \"sppm\" do.",
                        scene, built.integratorName));
    if (built.scene->Lights().Size() == 0) throw UserError(fmt::format("{}: has no lights.", scene));
}

LabScene LoadLabScene(const ExperimentSettings &settings, const PluginRegistry &registry, Progress &progress) {
    LabScene scene;
    DiagnosticSink sink;
    auto printWarnings = [&] {
        for (const Diagnostic &d : sink.All())
            if (d.severity == Severity::Warning) LogInfo(Format(d));
    };
    SceneDescription description = ParseSceneFiles({settings.scene}, sink);
    sink.ThrowIfErrors();
    BuildOptions options;
    options.film.resolutionDivisor = settings.resolutionDivisor;
    options.film.filename = "lightlab.exr";  // never written; the scene's own format may be unsupported
    options.samplesPerPixel = settings.Timed() ? 0 : settings.samplesPerPixel;
    options.maxDepth = settings.maxDepth;
    options.sampledLightOnly = settings.sampledLightOnly;
    options.lightSamplerFlag = kSamplersFlag;
    options.lightSampler = "uniform";  // for the unused default integrator: nothing to build
    progress.BeginPhase("building", 0);
    scene.built = BuildScene(description, options, registry, sink, progress);
    progress.EndPhase();
    CheckSamplesLights(scene.built, settings.scene);
    printWarnings();
    scene.hash = SceneHash(settings.scene);
    return scene;
}

}  // namespace ext::lab
