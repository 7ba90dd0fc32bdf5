#pragma once
#include "pbrt/integrators/integrator.h"
#include "pbrt/transport/path_walk.h"

namespace pbrt {

/// What a camera path starts with.
struct PathStart {
    const RenderPass &pass;  ///< which the path belongs to; integrators that splat add to its film
    CameraRay ray;
    Point2i pixel{};
    int sampleIndex = 0;                               ///< of the pixel
    std::optional<VisibleSurface> *visible = nullptr;  ///< null, or where PathWalk writes what the camera sees
    Float filterWeight = 1;                            ///< FilmSample::weight of the sample
};

/// Base of integrators that compute the radiance of one camera ray at a time, for the pixel that the ray belongs to.
class PixelIntegrator : public Integrator {
  public:
    bool Render(const RenderPass &pass) override;
    /// Radiance along a camera ray. Const while rendering.
    virtual SampledSpectrum Li(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler) const = 0;
    /// True if Li adds splats to the film of the pass (where RenderPass::keepsSamples), for one light path a call.
    virtual bool Splats() const { return false; }

  protected:
    /// The number that chooses the wavelengths of all samples of the pass; nothing: every sample has its own.
    virtual std::optional<Float> CommonWavelengths() const { return std::nullopt; }
};

}  // namespace pbrt
