#pragma once
#include <nlohmann/json.hpp>

#include "pbrt/cameras/camera.h"
#include "pbrt/lightsamplers/light_sampler.h"
#include "pbrt/lightsamplers/shadow_ray_gate.h"
#include "pbrt/samplers/sampler.h"
#include "pbrt/scene/scene.h"

namespace pbrt {

/// What every integrator may use.
struct IntegratorContext {
    const Scene &scene;
    const Camera &camera;
    int samplesPerPixel = 1;     ///< for texture footprints
    bool needsFootprints = true; ///< some material looks at filter footprints
};

/// Radiance along camera rays. Const while rendering.
class Integrator {
  public:
    virtual ~Integrator() = default;
    /// Before the first wave; the light sampler's prepass happens here.
    virtual void Prepare(PrepareContext &) {}
    virtual SampledSpectrum Li(CameraRay ray, SampledWavelengths &lambda, Sampler &sampler) const = 0;
    /// What has to be told of every path, and between waves; null if nothing.
    virtual LightLearner *Learner() { return nullptr; }
    /// The light sampler in use; null if the integrator has none.
    virtual const LightSampler *Lights() const { return nullptr; }
    /// The shadow-ray gate in use, or null.
    virtual const ShadowRayGate *Gate() const { return nullptr; }
};

}  // namespace pbrt
