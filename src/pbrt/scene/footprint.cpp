#include "pbrt/scene/shading.h"

namespace pbrt {
namespace {

/// Offset from the point to the ray's hit with the tangent plane; zero if parallel.
Vector3 PlaneOffset(const SurfacePoint &point, const Point3 &o, const Vector3 &d) {
    Float t = Dot(point.n, point.p - o) / Dot(point.n, d);
    if (!std::isfinite(t)) return Vector3(0);
    return o + d * t - point.p;
}

/// Least-squares (u, v) step for a displacement dp along the surface.
Vector2 ParameterStep(const SurfacePoint &point, const Vector3 &dp, Float inverseDeterminant, Float uu, Float uv,
                      Float vv) {
    Float bu = Dot(point.dpdu, dp), bv = Dot(point.dpdv, dp);
    Float du = DifferenceOfProducts(vv, bu, uv, bv) * inverseDeterminant;
    Float dv = DifferenceOfProducts(uu, bv, uv, bu) * inverseDeterminant;
    constexpr Float kMax = 1e8f;
    auto bounded = [=](Float x) { return std::isfinite(x) ? std::clamp(x, -kMax, kMax) : Float(0); };
    return {bounded(du), bounded(dv)};
}

/// Differentials of a scattered ray from those it arrived with. `scattered` maps the direction of an arriving ray and
/// the change of the shading normal to the new direction. Invalid if too large.
RayDifferential Scattered(const SurfacePoint &point, const RayDifferential &arrived, auto scattered) {
    RayDifferential d;
    if (!arrived.valid) return d;
    const SurfacePoint::Shading &shading = point.shading;
    d.rxOrigin = point.p + point.dpdx;
    d.ryOrigin = point.p + point.dpdy;
    d.rxDirection = scattered(arrived.rxDirection, shading.dndu * point.dudx + shading.dndv * point.dvdx);
    d.ryDirection = scattered(arrived.ryDirection, shading.dndu * point.dudy + shading.dndv * point.dvdy);
    constexpr Float kMaxSquare = 1e16f;
    Float largest = std::max(std::max(LengthSquared(d.rxDirection), LengthSquared(d.ryDirection)),
                             std::max(LengthSquared(d.rxOrigin), LengthSquared(d.ryOrigin)));
    d.valid = largest < kMaxSquare;
    return d;
}

}  // namespace

void ComputeFootprint(SurfacePoint &point, const RayDifferential &differential, const Camera &camera,
                      int samplesPerPixel) {
    if (differential.valid && Dot(point.n, differential.rxDirection) != 0 &&
        Dot(point.n, differential.ryDirection) != 0) {
        point.dpdx = PlaneOffset(point, differential.rxOrigin, differential.rxDirection);
        point.dpdy = PlaneOffset(point, differential.ryOrigin, differential.ryDirection);
    } else {
        camera.ApproximateFootprint(point.p, point.n, point.time, samplesPerPixel, &point.dpdx, &point.dpdy);
    }
    Float uu = Dot(point.dpdu, point.dpdu), uv = Dot(point.dpdu, point.dpdv), vv = Dot(point.dpdv, point.dpdv);
    Float inverse = 1 / DifferenceOfProducts(uu, vv, uv, uv);
    if (!std::isfinite(inverse)) inverse = 0;
    Vector2 x = ParameterStep(point, point.dpdx, inverse, uu, uv, vv);
    Vector2 y = ParameterStep(point, point.dpdy, inverse, uu, uv, vv);
    point.dudx = x.x;
    point.dvdx = x.y;
    point.dudy = y.x;
    point.dvdy = y.y;
}

RayDifferential ReflectDifferential(const SurfacePoint &point, const RayDifferential &arrived, const Vector3 &wi) {
    const Vector3 &n = point.shading.n, &wo = point.wo;
    return Scattered(point, arrived, [&](const Vector3 &arrivedDirection, const Normal3 &dn) {
        Vector3 dwo = -arrivedDirection - wo;
        Float dCos = Dot(dwo, n) + Dot(wo, dn);
        return wi - dwo + Float(2) * (Dot(wo, n) * dn + dCos * n);
    });
}

RayDifferential TransmitDifferential(const SurfacePoint &point, const RayDifferential &arrived, const Vector3 &wi,
                                     Float eta) {
    const Vector3 &wo = point.wo;
    const bool inside = Dot(wo, point.shading.n) < 0;
    const Normal3 n = inside ? -point.shading.n : point.shading.n;
    // wi = -wo / eta + mu n with mu = cos_o / eta - |cos_i|; both terms are differentiated.
    Float cosO = Dot(wo, n), cosI = AbsDot(wi, n);
    Float mu = cosO / eta - cosI;
    return Scattered(point, arrived, [&](const Vector3 &arrivedDirection, const Normal3 &dnOutside) {
        const Normal3 dn = inside ? -dnOutside : dnOutside;
        Vector3 dwo = -arrivedDirection - wo;
        Float dCos = Dot(dwo, n) + Dot(wo, dn);
        Float dMu = dCos * (1 / eta - cosO / (Sqr(eta) * cosI));
        return wi - dwo / eta + mu * dn + dMu * n;
    });
}

}  // namespace pbrt
