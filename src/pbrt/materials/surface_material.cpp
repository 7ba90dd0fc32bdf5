#include "pbrt/materials/material_params.h"

#include "pbrt/math/frame.h"

namespace pbrt {
namespace {

/// Finite difference step in u or v where the footprint is unknown.
constexpr Float kDefaultStep = 5e-4f;

Float Step(Float perPixelX, Float perPixelY) {
    Float half = (std::abs(perPixelX) + std::abs(perPixelY)) / 2;
    return half > 0 ? half : kDefaultStep;
}

}  // namespace

void ApplyBumpMap(const FloatTexture &height, SurfacePoint &point) {
    SurfacePoint::Shading &shading = point.shading;
    const TextureContext here(point);
    const Float elevation = height.Evaluate(here);
    // Tangents of the displaced surface p + height n: dp/du + (dheight/du) n + height dn/du, likewise for v.
    auto tangent = [&](const Vector3 &dpds, const Normal3 &dnds, const Point2 &uvStep, Float step) {
        TextureContext beside = here;
        beside.p += dpds * step;
        beside.uv += uvStep;
        return dpds + shading.n * ((height.Evaluate(beside) - elevation) / step) + dnds * elevation;
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

void ApplyNormalMap(const Image &image, SurfacePoint &point) {
    Point2 st(point.uv.x, 1 - point.uv.y);
    Vector3 mapped;
    for (int c = 0; c < 3; ++c) mapped[c] = 2 * image.Bilinear(st, c, WrapMode::Repeat) - 1;
    if (!(LengthSquared(mapped) > 0)) return;

    SurfacePoint::Shading &shading = point.shading;
    Vector3 ns = Normalize(Frame::FromXZ(shading.dpdu, shading.n).FromLocal(Normalize(mapped)));
    Vector3 along = shading.dpdu - ns * Dot(ns, shading.dpdu);
    if (!(LengthSquared(along) > 0)) return;
    along = Normalize(along);
    shading.dpdu = along * Length(shading.dpdu);
    shading.dpdv = Cross(ns, along) * Length(shading.dpdv);
    shading.n = FaceForward(ns, point.n);
}

}  // namespace pbrt
