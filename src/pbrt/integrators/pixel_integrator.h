#pragma once
#include "pbrt/integrators/integrator.h"
#include "pbrt/paths/path_walk.h"

namespace pbrt {

/// What a path from the camera starts with.
struct PathStart {
    CameraRay ray;
    Point2i pixel{};
    int sample = 0;  ///< of the pixel; counts on over all batches
    /// If it is not null it is told of the first surface that scatters (VisibleSurfaceReport).
    std::optional<VisibleSurface> *visible = nullptr;
};

/// The integrators that find the radiance of one camera ray at a time, for the pixel that the ray belongs to.
class PixelIntegrator : public Integrator {
  public:
    bool Render(const RenderPass &pass) final;
    /// Radiance along a camera ray. Const while rendering.
    virtual SampledSpectrum Li(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler) const = 0;
};

}  // namespace pbrt
