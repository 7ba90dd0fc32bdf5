#include "pbrt/integrators/visible_surface.h"

#include "pbrt/bxdfs/albedo.h"
#include "pbrt/integrators/path_common.h"

namespace pbrt {

std::optional<VisibleSurface> FindVisibleSurface(const IntegratorContext &context, const Transform &outputFromRender,
                                                 const CameraRay &ray, const SampledWavelengths &lambda) {
    PathRay path{ray.ray, ray.differential};
    while (std::optional<SurfacePoint> hit = context.scene.Intersect(path.ray)) {
        SurfacePoint &point = *hit;
        ComputeFootprint(point, path.differential, context.camera, context.samplesPerPixel);
        VisibleSurface visible;
        visible.lambda = lambda;
        const Bsdf bsdf = ComputeBsdf(context.scene, point, visible.lambda);
        if (!bsdf) {
            path.PassThrough(point);
            continue;
        }
        visible.p = outputFromRender.Point(point.p);
        visible.n = Normalize(outputFromRender.Normal(FaceForward(point.n, point.wo)));
        visible.ns = Normalize(outputFromRender.Normal(FaceForward(point.shading.n, point.wo)));
        visible.uv = point.uv;
        visible.dzdx = std::abs(outputFromRender.Vector(point.dpdx).z);
        visible.dzdy = std::abs(outputFromRender.Vector(point.dpdy).z);
        visible.albedo = EstimateAlbedo(bsdf, point.wo);
        return visible;
    }
    return {};
}

}  // namespace pbrt
