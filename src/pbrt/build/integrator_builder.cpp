#include "pbrt/build/integrator_builder.h"

#include <algorithm>
#include <limits>

#include "pbrt/integrators/path_integrator.h"
#include "pbrt/integrators/simple_integrators.h"

namespace pbrt {

const std::vector<std::string> &SupportedIntegrators() {
    static const std::vector<std::string> names = {"path", "volpath", "simplepath", "ambientocclusion", "randomwalk"};
    return names;
}

const std::vector<std::string> &UnsupportedIntegrators() {
    static const std::vector<std::string> names = {"simplevolpath", "lightpath", "bdpt", "mlt", "sppm", "function"};
    return names;
}

const std::string &IntegratorType(const Entity &entity, const BuildOptions &options) {
    return options.integrator.empty() ? entity.type : options.integrator;
}

bool SeesThroughInterfaces(const std::string &integrator) { return integrator == "volpath"; }

IntegratorSettings ReadIntegrator(const Entity &entity, const BuildOptions &options,
                                  const LightSamplerRegistry &registry, DiagnosticSink &sink) {
    IntegratorSettings settings;
    settings.type = IntegratorType(entity, options);
    const std::string &type = settings.type;
    const std::vector<std::string> &later = UnsupportedIntegrators();
    if (const std::vector<std::string> &all = SupportedIntegrators();
        std::find(all.begin(), all.end(), type) == all.end()) {
        const bool isLater = std::find(later.begin(), later.end(), type) != later.end();
        sink.Error(options.integrator.empty() ? entity.loc : FileLoc{},
                   fmt::format("Integrator \"{}\" is {}; {}.", type, isLater ? "not supported yet" : "unknown",
                               ListChoices(type, all)));
        return settings;
    }
    // --integrator leaves the scene's integrator parameters aside: they belong to another integrator.
    const ParamSet fresh(fmt::format("Integrator \"{}\"", options.integrator), {});
    const ParamSet &params = type != entity.type ? fresh : entity.params;
    auto collect = [&](auto &&read) {
        try {
            read();
        } catch (const UserError &e) {
            sink.Add(e);
        }
    };
    if (type != "ambientocclusion")
        collect([&] {
            params.GetInt("maxdepth", 5);
            const int maxDepth = entity.params.GetInt("maxdepth", 5, {0, std::numeric_limits<int>::max()});
            settings.maxDepth = options.maxDepth.value_or(maxDepth);
        });
    if (type == "path" || type == "volpath") {
        collect([&] { settings.regularize = params.GetBool("regularize", false); });
        settings.sampledLightOnly = options.sampledLightOnly;
        const LightFlags flags{options.lightSampler, options.meshLights, options.shadowGate, options.lightSamplerFlag,
                               options.shadowGateFlag};
        collect([&] { settings.lights = ReadLightSelection(params, flags, registry, sink); });
    } else if (!options.lightSampler.empty() || options.meshLights || !options.shadowGate.empty()) {
        sink.Warning(
            {},
            fmt::format("--lightsampler, --mesh-lights and --shadow-gate have no effect on integrator \"{}\".", type));
    }
    if (type == "simplepath")
        collect([&] {
            settings.sampleLights = params.GetBool("samplelights", true);
            settings.sampleBsdf = params.GetBool("samplebsdf", true);
        });
    if (type == "ambientocclusion")
        collect([&] {
            settings.cosineSample = params.GetBool("cossample", true);
            settings.maxDistance =
                params.GetFloat("maxdistance", Infinity, Positive(std::numeric_limits<Float>::max()));
        });
    params.ReportUnused(sink);
    return settings;
}

BuiltIntegrator MakeIntegrator(const IntegratorSettings &settings, const LightSamplerRegistry &registry,
                               const PathContext &context, const ColorSpace &filmSpace, DiagnosticSink &sink) {
    const std::string &type = settings.type;
    BuiltIntegrator built;
    built.name = type;
    built.maxDepth = settings.maxDepth;
    // Without media (which are not supported yet) volpath is path that looks below and through surfaces.
    if (settings.lights) {
        PathSettings path;
        path.maxDepth = settings.maxDepth;
        path.regularize = settings.regularize;
        path.seesThroughInterfaces = SeesThroughInterfaces(type);
        path.subsurface = type == "volpath" && context.scene.HasSubsurface();
        path.sampledLightOnly = settings.sampledLightOnly;
        const auto &[sampler, gate] = *settings.lights;
        built.lightSamplerName = sampler.Label();
        built.shadowGateName = gate.entry ? gate.entry->name : "";
        built.integrator = std::make_unique<PathIntegrator>(
            context, path, registry.Make(*sampler.entry, context.scene.Lights(), sampler.params, sampler.meshLights),
            gate.entry ? gate.entry->make(context.scene.Lights(), gate.params) : nullptr);
    } else if (type == "simplepath") {
        built.integrator = std::make_unique<SimplePathIntegrator>(context, settings.maxDepth, settings.sampleLights,
                                                                  settings.sampleBsdf);
    } else if (type == "randomwalk") {
        built.integrator = std::make_unique<RandomWalkIntegrator>(context, settings.maxDepth);
    } else {
        PBRT_CHECK_MSG(type == "ambientocclusion", "integrator {}", type);
        built.integrator = std::make_unique<AmbientOcclusionIntegrator>(context, settings.cosineSample,
                                                                        settings.maxDistance, filmSpace);
    }
    if (type != "volpath" && context.scene.HasSubsurface())
        sink.Warning(
            {},
            fmt::format("subsurface materials are plain dielectrics to integrator \"{}\"; \"volpath\" scatters light "
                        "below their surfaces.",
                        type));
    return built;
}

}  // namespace pbrt
