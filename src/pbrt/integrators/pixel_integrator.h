#pragma once
#include "pbrt/integrators/integrator.h"
#include "pbrt/paths/path_walk.h"

namespace pbrt {

/// What a camera path starts with.
struct PathStart {
    CameraRay ray;
    Point2i pixel{};
    int sampleIndex = 0;                               ///< of the pixel
    std::optional<VisibleSurface> *visible = nullptr;  ///< where PathWalk says what the camera sees, if somebody asks
};

/// The integrators that find the radiance of one camera ray at a time, for the pixel that the ray belongs to.
class PixelIntegrator : public Integrator {
  public:
    bool Render(const RenderPass &pass) final;
    /// Radiance along a camera ray. Const while rendering.
    virtual SampledSpectrum Li(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler) const = 0;
};

}  // namespace pbrt
