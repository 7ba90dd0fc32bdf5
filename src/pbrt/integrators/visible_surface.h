#pragma once
#include "pbrt/films/visible_surface.h"
#include "pbrt/paths/path_walk.h"

namespace pbrt {

/// What a path does to say what the camera sees; nothing is done unless somebody wants to know.
class VisibleSurfaceReport {
  public:
    /// `camera` must live as long. `visible`: null if nobody wants to know.
    VisibleSurfaceReport(const PathContext &context, const CameraRay &camera, std::optional<VisibleSurface> *visible)
        : context_(context), camera_(camera), visible_(visible) {}

    /// At every vertex of the path; the first one counts.
    void See(const PathWalk &walk, const SampledWavelengths &lambda) const {
        if (visible_ && !*visible_) Fill(walk, lambda);
    }
    /// Where a path ends before it knows whether its surface scatters: looks on from there.
    void LookOn(const PathWalk &walk, const SampledWavelengths &lambda) const {
        if (visible_ && !*visible_) FillBeyond(walk, lambda);
    }

  private:
    void Fill(const PathWalk &walk, const SampledWavelengths &lambda) const;
    void FillBeyond(PathWalk walk, SampledWavelengths lambda) const;
    const PathContext &context_;
    const CameraRay &camera_;
    std::optional<VisibleSurface> *visible_;
};

}  // namespace pbrt
