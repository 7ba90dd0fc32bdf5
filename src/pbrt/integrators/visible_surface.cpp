#include "pbrt/integrators/visible_surface.h"

#include "pbrt/bxdfs/albedo.h"

namespace pbrt {

void VisibleSurfaceReport::Fill(const PathWalk &walk, const SampledWavelengths &lambda) const {
    SurfacePoint point = walk.Vertex().point;
    // The path may do without footprints; then its differentials do not count any more.
    RayDifferential differential = walk.Differential();
    differential.valid = camera_.differential.valid;
    ComputeFootprint(point, differential, context_.camera, context_.samplesPerPixel);
    VisibleSurface &visible = visible_->emplace();
    visible.p = point.p;
    visible.n = FaceForward(point.n, point.wo);
    visible.ns = FaceForward(point.shading.n, point.wo);
    visible.uv = point.uv;
    visible.dpdx = point.dpdx;
    visible.dpdy = point.dpdy;
    visible.time = point.time;
    visible.albedo = EstimateAlbedo(walk.Vertex().bsdf, point.wo);
    visible.lambda = lambda;
}

void VisibleSurfaceReport::FillBeyond(PathWalk walk, SampledWavelengths lambda) const {
    do {
        if (walk.FindScattering(lambda)) return Fill(walk, lambda);
    } while (walk.Next() == PathWalk::Met::Surface);
}

}  // namespace pbrt
