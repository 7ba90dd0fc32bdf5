#pragma once
#include <string>

#include "pbrt/build/built_scene.h"
#include "pbrt/integrators/registry.h"

namespace pbrt::test {

/// The registry with all light samplers of this build.
const PluginRegistry &AllSamplers();
/// A light sampler as written for --lightsampler, not prepared. Throws UserError.
std::unique_ptr<LightSampler> MakeLightSampler(const std::string &choice, const LightTable &lights,
                                               const PluginRegistry &registry = AllSamplers());
/// Prepares a light sampler for a render of the scene.
void PrepareIn(const BuiltScene &built, LightSampler &sampler);

/// A scene from text, ready to render; all light samplers of the build are registered. Throws UserError.
BuiltScene BuildText(const std::string &text, const BuildOptions &options = {});
/// The same from a file.
BuiltScene BuildFile(const std::string &file, const BuildOptions &options = {});

}  // namespace pbrt::test
