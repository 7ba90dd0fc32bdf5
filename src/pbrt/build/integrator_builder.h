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
    std::optional<LightSelection> lights;  ///< of path and volpath
    /// From settings without errors; the registry that they were read with must still live.
    std::function<std::unique_ptr<Integrator>(const PathContext &, const ColorSpace &filmSpace)> make;
};

/// What the parameters of an integrator are read for.
struct IntegratorReading {
    const BuildOptions &options;
    const LightSamplerRegistry &registry;
    DiagnosticSink &sink;
    const ParamReader &before;  ///< knows the parameters of light samplers
};
using IntegratorTable = FactoryTable<IntegratorSettings, const IntegratorReading>;
const IntegratorTable &Integrators();
/// Those that the format has and we do not.
const std::vector<std::string> &UnsupportedIntegrators();

/// Reads the parameters of the integrator that the scene or --integrator names, and of its light sampler. Everything
/// wrong with them goes to the sink, before anything is built.
IntegratorSettings ReadIntegrator(const Entity &entity, const BuildOptions &options,
                                  const LightSamplerRegistry &registry, DiagnosticSink &sink);

/// Makes it, from settings without errors.
BuiltIntegrator MakeIntegrator(const IntegratorSettings &settings, const PathContext &context,
                               const ColorSpace &filmSpace, DiagnosticSink &sink);

/// The one to be used: of the scene's entity, or what --integrator names.
const std::string &IntegratorType(const Entity &entity, const BuildOptions &options);
/// True if light sampling passes interface surfaces; the scene's geometry is built for it.
bool SeesThroughInterfaces(const std::string &integrator);

}  // namespace pbrt
