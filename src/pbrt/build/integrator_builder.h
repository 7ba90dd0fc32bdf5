#pragma once
#include "pbrt/build/built_scene.h"

namespace pbrt {

/// Reads integrator and light-sampler parameters and makes both, into `built` (scene and camera must exist).
void MakeIntegrator(const Entity &entity, const BuildOptions &options, const LightSamplerRegistry &registry,
                    const IntegratorContext &context, const ColorSpace &filmSpace, BuiltScene &built, DiagnosticSink &sink);

const std::vector<std::string> &SupportedIntegrators();
const std::vector<std::string> &UnsupportedIntegrators();

}  // namespace pbrt
