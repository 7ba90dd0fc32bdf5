#include "pbrt/integrators/visible_surface.h"

#include "pbrt/bxdfs/albedo.h"

namespace pbrt {

void VisibleSurfaceReport::Fill(SurfacePoint point, const Bsdf &bsdf, const PathRay &path,
                                const SampledWavelengths &lambda) const {
    // The path may do without footprints; then it has dropped its differentials.
    RayDifferential differential = path.differential;
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
    visible.albedo = EstimateAlbedo(bsdf, point.wo);
    visible.lambda = lambda;
}

void VisibleSurfaceReport::FillBeyond(SurfacePoint point, PathRay path, SampledWavelengths lambda) const {
    while (true) {
        FindFootprint(context_, point, path);
        if (const Bsdf bsdf = ComputeBsdf(context_.scene, point, lambda)) return Fill(point, bsdf, path, lambda);
        path.PassThrough(point);
        const std::optional<SurfacePoint> hit = context_.scene.Intersect(path.ray);
        if (!hit) return;
        point = *hit;
    }
}

}  // namespace pbrt
