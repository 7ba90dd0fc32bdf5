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
    int samplesPerPixel = 0;  ///< above 0: takes the place of the sampler's, unless --spp or --quick says otherwise
    bool samplesPixels =
        true;  ///< false: no sample belongs to a pixel, so that --disable-pixel-jitter cannot be obeyed
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
    const ParamReader &before;  ///< knows the parameters of light samplers
};
using IntegratorTable = FactoryTable<IntegratorSettings, const IntegratorReading>;
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
/// True if light is followed from the lights to the camera, which must be able to connect (Camera::CanConnect).
bool FollowsLight(const std::string &integrator);
/// True if direction sampling can take the place of BSDFs.
bool IsGuided(const std::string &integrator);
/// True if light sampling passes interface surfaces; the scene's geometry is built for it.
bool SeesThroughInterfaces(const std::string &integrator);
/// True if light is followed through media.
bool RendersMedia(const std::string &integrator);

}  // namespace pbrt
