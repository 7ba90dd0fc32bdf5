#include "pbrt/materials/bump_map.h"

namespace pbrt {

namespace {

/// Finite difference step in u or v where the footprint is unknown.
constexpr Float kDefaultStep = 5e-4f;

Float Step(Float perPixelX, Float perPixelY) {
    Float half = (std::abs(perPixelX) + std::abs(perPixelY)) / 2;
    return half > 0 ? half : kDefaultStep;
}

}  // namespace

void BumpMap::Perturb(SurfacePoint &point) const {
    SurfacePoint::Shading &shading = point.shading;
    const TextureContext here(point);
    const Float height = height_->Evaluate(here);
    // Tangents of the displaced surface p + height n: dp/du + (dheight/du) n + height dn/du, likewise for v.
    auto tangent = [&](const Vector3 &dpds, const Normal3 &dnds, const Point2 &uvStep, Float step) {
        TextureContext beside = here;
        beside.p += dpds * step;
        beside.uv += uvStep;
        return dpds + shading.n * ((height_->Evaluate(beside) - height) / step) + dnds * height;
    };
    const Float du = Step(point.dudx, point.dudy), dv = Step(point.dvdx, point.dvdy);
    const Vector3 dpdu = tangent(shading.dpdu, shading.dndu, {du, 0}, du);
    const Vector3 dpdv = tangent(shading.dpdv, shading.dndv, {0, dv}, dv);
    const Vector3 across = Cross(dpdu, dpdv);
    if (!(LengthSquared(across) > 0)) return;
    shading.dpdu = dpdu;
    shading.dpdv = dpdv;
    shading.n = FaceForward(Normalize(across), point.n);
}

}  // namespace pbrt
