#include "pbrt/build/integrator_builder.h"

#include <algorithm>
#include <limits>

#include "pbrt/build/light_sampler_spec.h"
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

BuiltIntegrator MakeIntegrator(const Entity &entity, const BuildOptions &options, const LightSamplerRegistry &registry,
                               const IntegratorContext &context, const ColorSpace &filmSpace, DiagnosticSink &sink) {
    BuiltIntegrator built;
    // --integrator leaves the scene's integrator parameters aside: they belong to another integrator.
    ParamSet fresh(fmt::format("Integrator \"{}\"", options.integrator), {});
    const std::string &type = IntegratorType(entity, options);
    const bool overridden = type != entity.type;
    const ParamSet &params = overridden ? fresh : entity.params;
    built.name = type;

    auto depth = [&] {
        params.GetInt("maxdepth", 5);
        const int maxDepth = entity.params.GetInt("maxdepth", 5, {0, std::numeric_limits<int>::max()});
        return built.maxDepth = options.maxDepth.value_or(maxDepth);
    };
    // Without media (which are not supported yet) volpath is path that looks below and through surfaces.
    if (type == "path" || type == "volpath") {
        PathSettings settings;
        settings.maxDepth = depth();
        settings.regularize = params.GetBool("regularize", false);
        settings.seesThroughInterfaces = SeesThroughInterfaces(type);
        settings.subsurface = type == "volpath" && context.scene.HasSubsurface();
        settings.sampledLightOnly = options.sampledLightOnly;
        LightSamplerSpec spec = ReadLightSamplerSpec(params, options.lightSampler, options.meshLights, registry,
                                                     options.lightSamplerFlag);
        built.lightSamplerName = spec.Label();
        ShadowGateSpec gate = ReadShadowGateSpec(params, options.shadowGate, registry, options.shadowGateFlag);
        built.shadowGateName = gate.entry ? gate.entry->name : "";
        built.integrator = std::make_unique<PathIntegrator>(
            context, settings, registry.Make(*spec.entry, context.scene.Lights(), spec.params, spec.meshLights),
            gate.entry ? gate.entry->make(context.scene.Lights(), gate.params) : nullptr);
    } else if (type == "simplepath") {
        int maxDepth = depth();
        built.integrator = std::make_unique<SimplePathIntegrator>(context, maxDepth, params.GetBool("samplelights", true),
                                                                  params.GetBool("samplebsdf", true));
    } else if (type == "randomwalk") {
        built.integrator = std::make_unique<RandomWalkIntegrator>(context, depth());
    } else if (type == "ambientocclusion") {
        bool cosine = params.GetBool("cossample", true);
        built.integrator = std::make_unique<AmbientOcclusionIntegrator>(
            context, cosine, params.GetFloat("maxdistance", Infinity, Positive(std::numeric_limits<Float>::max())),
            filmSpace);
    } else {
        std::vector<std::string> all = SupportedIntegrators();
        throw UserError(fmt::format("Integrator \"{}\" is {}; {}.", type,
                                    std::count(UnsupportedIntegrators().begin(), UnsupportedIntegrators().end(), type)
                                        ? "not supported yet" : "unknown",
                                    ListChoices(type, all)),
                        overridden ? FileLoc{} : entity.loc);
    }
    if (built.lightSamplerName.empty() && (!options.lightSampler.empty() || options.meshLights || !options.shadowGate.empty()))
        sink.Warning({}, fmt::format("--lightsampler, --mesh-lights and --shadow-gate have no effect on integrator \"{}\".", type));
    if (type != "volpath" && context.scene.HasSubsurface())
        sink.Warning({}, fmt::format("subsurface materials are plain dielectrics to integrator \"{}\"; \"volpath\" scatters light "
                                     "below their surfaces.", type));
    params.ReportUnused(sink);
    return built;
}

}  // namespace pbrt
