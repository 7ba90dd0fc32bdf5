#pragma once
#include "pbrt/integrators/integrator.h"
#include "pbrt/scene/scene.h"

namespace pbrt {

/// What every integrator of this kind may use.
struct IntegratorContext {
    const Scene &scene;
    const Camera &camera;
    int samplesPerPixel = 1;     ///< for texture footprints
    bool needsFootprints = true; ///< some material looks at filter footprints
};

/// The integrators that find the radiance of one camera ray at a time, for the pixel that the ray belongs to.
class PixelIntegrator : public Integrator {
  public:
    bool Render(const RenderPass &pass) final;
    /// Radiance along a camera ray. Const while rendering. `visible`, if it is not null, is told of the first surface
    /// that scatters (SeeSurface).
    virtual SampledSpectrum Li(CameraRay ray, SampledWavelengths &lambda, Sampler &sampler,
                               std::optional<VisibleSurface> *visible) const = 0;
};

}  // namespace pbrt
