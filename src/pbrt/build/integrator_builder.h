#pragma once
#include <functional>
#include <optional>

#include "pbrt/build/built_scene.h"
#include "pbrt/build/light_sampler_spec.h"
#include "pbrt/core/factory_table.h"
#include "pbrt/integrators/pixel_integrator.h"

namespace pbrt {

/// An integrator whose parameters were read, to be made when there is a scene.
struct IntegratorSettings {
    std::string type;
    int maxDepth = 5;
    int samplesPerPixel = 0;  ///< above 0: takes the place of the sampler's, unless --spp or --quick overrides it
    std::optional<LightSelection> lights;      ///< of integrators that take a light sampler
    std::optional<LightSamplerSpec> shooting;  ///< of integrators that follow light from the lights
    /// May be called only if reading gave no errors; the registry used then must still exist.
    std::function<std::unique_ptr<Integrator>(const PathContext &, const ColorSpace &filmSpace)> make;
};

/// What is needed to read the parameters of an integrator.
struct IntegratorReading {
    const BuildOptions &options;
    const PluginRegistry &registry;
    DiagnosticSink &sink;
    const ParamReader &before;  ///< has declared the parameters of light samplers
};

/// What an integrator does and needs; declared where it is registered.
struct IntegratorTraits {
    bool hasLightSampler = false;     ///< takes the light samplers' parameters and flags
    bool hasEmissionSampler = false;  ///< light paths begin at lights that a second light sampler chooses
    bool connectsToCamera = false;    ///< light paths reach the camera, which must support Camera::CanConnect
    bool isGuided = false;            ///< DirectionSampling can take the place of BSDFs
    bool rendersMedia = false;        ///< follows light through media
    bool passesInterfaces = false;    ///< shadow rays pass interface surfaces; geometry is built for it
    bool scattersSubsurface = false;  ///< other integrators render subsurface materials as dielectrics
    bool samplesPixels = true;        ///< false: no sample belongs to a pixel, which --disable-pixel-jitter needs
};
using IntegratorTable = FactoryTable<IntegratorSettings, const IntegratorReading, IntegratorTraits>;
const IntegratorTable &Integrators();
/// The integrators that the format has but this renderer does not support.
const std::vector<std::string> &UnsupportedIntegrators();

/// Reads the parameters of the integrator that the scene or --integrator names, and of its light sampler. Everything
/// wrong with them goes to the sink, before anything is built.
IntegratorSettings ReadIntegrator(const Entity &entity, const BuildOptions &options, const PluginRegistry &registry,
                                  DiagnosticSink &sink);

/// Makes the integrator, from settings that were read without errors.
BuiltIntegrator MakeIntegrator(const IntegratorSettings &settings, const PathContext &context,
                               const ColorSpace &filmSpace, DiagnosticSink &sink);

/// The type of the integrator to be used: that of the scene's entity, or the one that --integrator names.
const std::string &IntegratorType(const Entity &entity, const BuildOptions &options);
/// The traits of that integrator; the defaults if there is none of that name.
IntegratorTraits TraitsOf(const std::string &integrator);

}  // namespace pbrt
