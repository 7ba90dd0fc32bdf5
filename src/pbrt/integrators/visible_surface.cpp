#include "pbrt/integrators/visible_surface.h"

#include "pbrt/bxdfs/albedo.h"
#include "pbrt/paths/path_walk.h"

namespace pbrt {

std::optional<VisibleSurface> FindVisibleSurface(const PathContext &context, const Transform &outputFromRender,
                                                 const CameraRay &ray, const SampledWavelengths &lambda) {
    PathContext always = context;
    always.needsFootprints = true;
    PathWalk walk(always, ray);
    VisibleSurface visible;
    visible.lambda = lambda;
    while (walk.Next() == PathWalk::Met::Surface) {
        if (!walk.FindScattering(visible.lambda)) continue;
        const auto &[point, bsdf] = walk.Vertex();
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
