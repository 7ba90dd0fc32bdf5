#pragma once
#include "pbrt/integrators/path_common.h"

namespace pbrt {

/// What a path does to say what the camera sees; nothing is done unless somebody wants to know.
class VisibleSurfaceReport {
  public:
    /// `camera` must live as long. `visible`: null if nobody wants to know.
    VisibleSurfaceReport(const IntegratorContext &context, const CameraRay &camera,
                         std::optional<VisibleSurface> *visible)
        : context_(context), camera_(camera), visible_(visible) {}

    /// At every surface of the path that scatters; the first one counts.
    void See(const SurfacePoint &point, const Bsdf &bsdf, const PathRay &path, const SampledWavelengths &lambda) const {
        if (visible_ && !*visible_) Fill(point, bsdf, path, lambda);
    }
    /// Where a path ends before it knows whether its surface scatters: looks on from there.
    void LookOn(const SurfacePoint &point, const PathRay &path, const SampledWavelengths &lambda) const {
        if (visible_ && !*visible_) FillBeyond(point, path, lambda);
    }

  private:
    void Fill(SurfacePoint point, const Bsdf &bsdf, const PathRay &path, const SampledWavelengths &lambda) const;
    void FillBeyond(SurfacePoint point, PathRay path, SampledWavelengths lambda) const;
    const IntegratorContext &context_;
    const CameraRay &camera_;
    std::optional<VisibleSurface> *visible_;
};

}  // namespace pbrt
