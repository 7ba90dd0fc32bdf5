#pragma once
#include "ext/lab/experiment_settings.h"
#include "pbrt/build/built_scene.h"

namespace ext::lab {

struct LabScene {
    BuiltScene built;
    std::string hash;  ///< SceneHash of its files
    Point2i FullResolution() const { return built.film->FullResolution(); }
    const Bounds2i &Pixels() const { return built.film->PixelBounds(); }
    Point2i Resolution() const { return Pixels().high - Pixels().low; }
    /// Samples per pixel of one sampler batch; longer renders add batches with other seeds. Texture filters depend on
    /// it, so it is equal for all runs and references.
    int Batch() const { return built.samplesPerPixel; }
    std::unique_ptr<Integrator> MakeIntegrator(const SamplerChoice &choice, std::optional<int> maxDepth = {}) const;
};

/// Throws UserError if the scene's integrator has no light sampler, or the scene has no lights.
void CheckSamplesLights(const BuiltScene &built, const std::string &scene);

/// Throws UserError; includes CheckSamplesLights.
LabScene LoadLabScene(const ExperimentSettings &settings, const PluginRegistry &registry, Progress &progress);

}  // namespace ext::lab
