#pragma once
#include <optional>

#include "pbrt/build/built_scene.h"
#include "pbrt/build/light_sampler_spec.h"
#include "pbrt/integrators/pixel_integrator.h"

namespace pbrt {

/// The parameters of an integrator.
struct IntegratorSettings {
    std::string type;
    int maxDepth = 5;
    std::optional<LightSelection> lights;               ///< path, volpath
    bool regularize = false, sampledLightOnly = false;  ///< path, volpath
    bool sampleLights = true, sampleBsdf = true;        ///< simplepath
    bool cosineSample = true;                           ///< ambientocclusion
    Float maxDistance = Infinity;                       ///< ambientocclusion
};

/// Reads the parameters of the integrator that the scene or --integrator names, and of its light sampler. Everything
/// wrong with them goes to the sink, before anything is built.
IntegratorSettings ReadIntegrator(const Entity &entity, const BuildOptions &options,
                                  const LightSamplerRegistry &registry, DiagnosticSink &sink);

/// Makes it, from settings without errors.
BuiltIntegrator MakeIntegrator(const IntegratorSettings &settings, const LightSamplerRegistry &registry,
                               const PathContext &context, const ColorSpace &filmSpace, DiagnosticSink &sink);

/// The one to be used: of the scene's entity, or what --integrator names.
const std::string &IntegratorType(const Entity &entity, const BuildOptions &options);
/// True if light sampling passes interface surfaces; the scene's geometry is built for it.
bool SeesThroughInterfaces(const std::string &integrator);

const std::vector<std::string> &SupportedIntegrators();
const std::vector<std::string> &UnsupportedIntegrators();

}  // namespace pbrt
