#pragma once
#include "pbrt/build/built_scene.h"

namespace pbrt {

/// Reads integrator and light-sampler parameters and makes both. Unused parameters are reported to the sink.
BuiltIntegrator MakeIntegrator(const Entity &entity, const BuildOptions &options, const LightSamplerRegistry &registry,
                               const IntegratorContext &context, const ColorSpace &filmSpace, DiagnosticSink &sink);

/// The one to be used: of the scene's entity, or what --integrator names.
const std::string &IntegratorType(const Entity &entity, const BuildOptions &options);
/// True if light sampling passes interface surfaces; the scene's geometry is built for it.
bool SeesThroughInterfaces(const std::string &integrator);

const std::vector<std::string> &SupportedIntegrators();
const std::vector<std::string> &UnsupportedIntegrators();

}  // namespace pbrt
