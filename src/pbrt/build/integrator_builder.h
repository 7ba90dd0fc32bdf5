#pragma once
#include <functional>
#include <optional>

#include "pbrt/build/built_scene.h"
#include "pbrt/build/light_sampler_spec.h"
#include "pbrt/core/factory_table.h"
#include "pbrt/integrators/pixel_integrator.h"

namespace pbrt {

/// An integrator with parsed parameters, created once the scene exists.
struct IntegratorSettings {
    std::string type;
    int maxDepth = 5;
    int samplesPerPixel = 0;               ///< positive: replaces the sampler's, unless --spp or --quick overrides it
    std::optional<LightSelection> lights;  ///< for integrators with a light sampler
    std::optional<LightSamplerSpec> shooting;  ///< for integrators with light paths
    /// Call only if parsing gave no errors; the registry used must still exist.
    std::function<std::unique_ptr<Integrator>(const PathContext &, const ColorSpace &filmSpace)> make;
};

struct IntegratorReading {
    const BuildOptions &options;
    const PluginRegistry &registry;
    DiagnosticSink &sink;
    const ParamReader &before;  ///< with the light samplers' parameters declared
};

/// Capabilities and requirements of an integrator, declared at its registration.
struct IntegratorTraits {
    bool hasLightSampler = false;     ///< accepts the light samplers' parameters and flags
    bool hasEmissionSampler = false;  ///< a second light sampler selects where light paths start
    bool connectsToCamera = false;    ///< requires Camera::CanConnect
    bool isGuided = false;            ///< supports DirectionSampling
    bool rendersMedia = false;        ///< traces media
    bool passesInterfaces = false;    ///< shadow rays pass interface surfaces; geometry is built for it
    bool scattersSubsurface = false;  ///< others render subsurface materials as dielectrics
    bool samplesPixels = true;        ///< false: samples do not belong to pixels, as --disable-pixel-jitter requires
};
using IntegratorTable = FactoryTable<IntegratorSettings, const IntegratorReading, IntegratorTraits>;
const IntegratorTable &Integrators();
/// Integrator of the format that is not supported.
inline constexpr const char *kUnsupportedIntegrator = "function";

/// Parses the parameters of the integrator named by scene or --integrator, and of its light sampler. Reports all errors
/// to the sink before anything is built.
IntegratorSettings ReadIntegrator(const Entity &entity, const BuildOptions &options, const PluginRegistry &registry,
                                  DiagnosticSink &sink);

/// Creates the integrator from settings that parsed without errors.
BuiltIntegrator MakeIntegrator(const IntegratorSettings &settings, const PathContext &context,
                               const ColorSpace &filmSpace, DiagnosticSink &sink);

/// Integrator type: the scene's, or that of --integrator.
const std::string &IntegratorType(const Entity &entity, const BuildOptions &options);
/// Traits of that integrator; defaults if the name is unknown.
IntegratorTraits TraitsOf(const std::string &integrator);

}  // namespace pbrt
