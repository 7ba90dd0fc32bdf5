#pragma once
#include "pbrt/build/built_scene.h"

namespace pbrt {

/// Reads integrator and light-sampler parameters and makes both. Unused parameters are reported to the sink.
BuiltIntegrator MakeIntegrator(const Entity &entity, const BuildOptions &options, const LightSamplerRegistry &registry,
                               const IntegratorContext &context, const ColorSpace &filmSpace, DiagnosticSink &sink);

const std::vector<std::string> &SupportedIntegrators();
const std::vector<std::string> &UnsupportedIntegrators();

}  // namespace pbrt
