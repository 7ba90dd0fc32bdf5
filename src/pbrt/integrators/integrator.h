#pragma once
#include "pbrt/lightsamplers/light_sampler.h"
#include "pbrt/lightsamplers/shadow_ray_gate.h"
#include "pbrt/paths/path_walk.h"
#include "pbrt/samplers/sampler.h"

namespace pbrt {

/// What a camera path starts with.
struct PathStart {
    CameraRay ray;
    Point2i pixel{};
    int sampleIndex = 0;  ///< of the pixel
};

/// Radiance along camera rays. Const while rendering.
class Integrator {
  public:
    virtual ~Integrator() = default;
    /// Before the first wave; the light sampler's prepass happens here.
    virtual void Prepare(PrepareContext &) {}
    virtual SampledSpectrum Li(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler) const = 0;
    /// What learns between waves; null if nothing does.
    virtual LightLearner *Learner() { return nullptr; }
    /// The light sampler in use; null if the integrator has none.
    virtual const LightSampler *Lights() const { return nullptr; }
    /// The shadow-ray gate in use, or null.
    virtual const ShadowRayGate *Gate() const { return nullptr; }
};

}  // namespace pbrt
