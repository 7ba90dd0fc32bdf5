#include "pbrt/integrators/visible_surface.h"

#include "pbrt/integrators/path_common.h"
#include "pbrt/math/low_discrepancy.h"

namespace pbrt {

namespace {

/// Hemispherical reflectance (and transmittance) by few points: without error for diffuse surfaces.
SampledSpectrum EstimateAlbedo(const Bsdf &bsdf, const SurfacePoint &point) {
    constexpr int kPoints = 16;
    // Where the lobe numbers lie in their strata decides whether a faint coat is found at all. As in stock pbrt-v4 the
    // smallest is 0.0473, above the reflectance of glass; the directions go with it so that it is for normal incidence.
    constexpr Float kOffset = Float(0.757);
    SampledSpectrum sum(0);
    for (int i = 0; i < kPoints; ++i) {
        const auto index = static_cast<uint64_t>(kPoints - i);
        const Point2 u(RadicalInverse(2, index), RadicalInverse(3, index));
        const Float uLobe = (static_cast<Float>(i) + kOffset) / kPoints;
        if (auto s = bsdf.Sample(point.wo, uLobe, u); s && s->pdf > 0)
            sum += s->f * (AbsDot(s->wi, point.shading.n) / s->pdf);
    }
    return sum / kPoints;
}

}  // namespace

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
        visible.albedo = EstimateAlbedo(bsdf, point);
        return visible;
    }
    return {};
}

}  // namespace pbrt
