#include "pbrt/scene/scene.h"

#include <type_traits>

#include "pbrt/core/counters.h"
#include "pbrt/scene/shading.h"
#include "pbrt/shapes/triangle_mesh.h"

namespace pbrt {
namespace {

/// Offset from the point to the ray's hit with the tangent plane; zero if parallel.
Vector3 PlaneOffset(const SurfacePoint &point, const Point3 &o, const Vector3 &d) {
    Float t = Dot(point.n, point.p - o) / Dot(point.n, d);
    if (!std::isfinite(t)) return Vector3(0);
    return o + d * t - point.p;
}

/// Least-squares (u, v) step for a displacement dp along the surface.
Vector2 ParameterStep(const Vector3 &dpdu, const Vector3 &dpdv, const Vector3 &dp, Float inverseDeterminant, Float uu,
                      Float uv, Float vv) {
    Float bu = Dot(dpdu, dp), bv = Dot(dpdv, dp);
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
    // A power of two keeps fourth powers of the lengths normal numbers.
    const Float size = std::max(MaxComponent(Abs(point.dpdu)), MaxComponent(Abs(point.dpdv)));
    const bool isUsual = (size > Float(1e-6) && size < Float(1e6)) || !(size > 0 && size < Infinity);
    const Float unit = isUsual ? Float(1) : std::ldexp(Float(1), -std::ilogb(size));
    const Vector3 dpdu = point.dpdu * unit, dpdv = point.dpdv * unit;
    Float uu = Dot(dpdu, dpdu), uv = Dot(dpdu, dpdv), vv = Dot(dpdv, dpdv);
    Float inverse = 1 / DifferenceOfProducts(uu, vv, uv, uv);
    if (!std::isfinite(inverse)) inverse = 0;
    Vector2 x = ParameterStep(dpdu, dpdv, point.dpdx * unit, inverse, uu, uv, vv);
    Vector2 y = ParameterStep(dpdu, dpdv, point.dpdy * unit, inverse, uu, uv, vv);
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

Scene::Scene(SceneContents contents) : contents_(std::move(contents)), bounds_(contents_.accel->Bounds()) {
    PBRT_CHECK(contents_.lights != nullptr);
    for (const MaterialPtr &m : contents_.materials) {
        if (!m) continue;
        hasSubsurface_ |= m->HasBssrdf();
        needsFootprints_ |= m->NeedsFootprint();
    }
    hasMedia_ = bool(contents_.cameraMedium);
    if (!bounds_.IsEmpty()) maxRounding_ = Gamma(64) * MaxComponent(Max(Abs(bounds_.low), Abs(bounds_.high)));
    for (const ShapeRecord &s : contents_.shapes) hasMedia_ |= s.insideMedium || s.outsideMedium;
}

MediumId Scene::MediumOfLight(LightId id, const Normal3 &n, const Vector3 &w) const {
    if (contents_.lightMedia.empty()) return {};
    const SceneContents::LightMedia &media = contents_.lightMedia[Lights().LightOf(id)];
    return Dot(n, w) < 0 ? media.inside : media.outside;
}

std::optional<SurfacePoint> Scene::Intersect(const Ray &ray) const {
    SurfacePoint point;
    if (!Intersect(ray, &point)) return {};
    return point;
}

bool Scene::Intersect(const Ray &ray, SurfacePoint *point) const {
    ++ThreadCounters().closestHitRays;
    std::optional<AccelHit> hit = contents_.accel->Intersect(ray);
    // Constructed in place, without a copy.
    static_assert(std::is_trivially_destructible_v<SurfacePoint>);
    if (hit) new (point) SurfacePoint(SurfaceAt(*hit, ray));
    return hit.has_value();
}

bool Scene::IntersectFromCamera(const Ray &ray, SurfacePoint *point) const {
    for (Float tMin = 0;;) {
        ++ThreadCounters().closestHitRays;
        const std::optional<AccelHit> hit = contents_.accel->Intersect(ray, tMin);
        if (!hit) return false;
        new (point) SurfacePoint(SurfaceAt(*hit, ray));
        if (AbsDot(point->n, point->p - ray.o) > maxRounding_ || !StartsInPlane(*hit, ray)) [[likely]]
            return true;
        tMin = hit->hit.t;
    }
}

bool Scene::StartsInPlane(const AccelHit &hit, const Ray &ray) const {
    const Shape &shape = *contents_.shapes[hit.shape.value].shape;
    // Transforms of the scene and of the camera were rounded in world space.
    const Vector3 error = Gamma(2) * (Abs(ray.o) + Vector3(Distance(ray.o, contents_.worldOrigin)));
    if (hit.instance < 0) return shape.IsInPlane(hit.primitive, ray.o, error);
    const Transform t = contents_.accel->InstanceTransform(hit.instance, ray.time).Inverse();
    return shape.IsInPlane(hit.primitive, t.Point(ray.o), t.PointError(ray.o, error));
}

std::optional<Scene::Crossing> Scene::SampleCrossing(const Point3 &from, const Point3 &to, Float time,
                                                     MaterialId material, Float u) const {
    const Ray segment{.o = from, .d = to - from, .tMax = 1, .time = time};
    AccelHit chosen;
    int count = 0;
    for (Float tMin = 0;;) {
        ++ThreadCounters().closestHitRays;
        std::optional<AccelHit> hit = contents_.accel->Intersect(segment, tMin);
        if (!hit) break;
        tMin = hit->hit.t;
        if (contents_.shapes[hit->shape.value].material != material) continue;
        // Reservoir sampling: the n-th crossing replaces the kept one with probability 1/n; u is rescaled.
        const Float keep = 1 - 1 / Float(++count);
        if (u >= keep) {
            chosen = *hit;
            u = std::min((u - keep) * Float(count), OneMinusEpsilon);
        } else {
            u /= keep;
        }
    }
    if (count == 0) return {};
    return Crossing{SurfaceAt(chosen, segment), count};
}

SurfacePoint Scene::SurfaceAt(const AccelHit &hit, const Ray &ray) const {
    const ShapeRecord &record = contents_.shapes[hit.shape.value];
    SurfacePoint point = hit.instance < 0 ? record.shape->SurfaceOnRay(hit.primitive, hit.hit, ray)
                                          : InstancedSurface(*record.shape, hit, ray);
    point.wo = -Normalize(ray.d);
    point.time = ray.time;
    point.t = hit.hit.t;
    point.shape = hit.shape;
    point.primitive = hit.primitive;
    point.material = record.material;
    if (record.firstLight && hit.instance < 0) point.light = LightId(record.firstLight.value + hit.primitive);
    // A surface with the same medium on both sides is inside the ray's current medium.
    const bool isBoundary = record.insideMedium != record.outsideMedium;
    point.insideMedium = isBoundary ? record.insideMedium : ray.medium;
    point.outsideMedium = isBoundary ? record.outsideMedium : ray.medium;
    return point;
}

SurfacePoint Scene::InstancedSurface(const Shape &shape, const AccelHit &hit, const Ray &ray) const {
    const Transform t = contents_.accel->InstanceTransform(hit.instance, ray.time);
    const Ray local{t.InversePoint(ray.o), t.InverseVector(ray.d)};
    const Mesh *const mesh = Mesh::Of(shape);
    if (!mesh) return TransformSurface(t, shape.SurfaceOnRay(hit.primitive, hit.hit, local));
    // The rows of the inverse are as long as the half extents of a unit ball in the mesh's space.
    const glm::mat3 m(t.InverseMatrix());
    const Vector3 ball = glm::sqrt(m[0] * m[0] + m[1] * m[1] + m[2] * m[2]);
    const Vector3 distance = hit.hit.t * Min(ball * Length(ray.d), Vector3(MaxComponent(Abs(local.d))));
    return TransformSurface(t, mesh->SurfaceInInstance(hit.primitive, hit.hit, local, distance));
}

Ray Scene::ShadowRay(const LightSampleContext &from, const LightLiSample &to) {
    // Rounding of direction and intersection moves the light's own surface by a few ulps of the segment's longest
    // component, besides the sample's position error.
    constexpr Float kRounding = Gamma(8);
    Ray ray{.o = from.OffsetOrigin(to.wi), .tMax = 1, .time = from.time};
    ray.d = to.pLight - ray.o;
    if (to.nLight == Normal3(0)) {
        ray.tMax -= kRounding;  // point lights and cameras may lie in the plane of a surface
        return ray;
    }
    const Vector3 error = to.pLightError + Vector3(kRounding * MaxComponent(Abs(ray.d)));
    ray.d = OffsetRayOrigin(to.pLight, error, to.nLight, -ray.d) - ray.o;
    return ray;
}

std::optional<Scene::Interface> Scene::NextInterface(const Ray &ray, Float tMin) const {
    for (;;) {
        ++ThreadCounters().closestHitRays;
        const std::optional<AccelHit> hit = contents_.accel->Intersect(ray, tMin);
        if (!hit) return {};
        tMin = hit->hit.t;
        const ShapeRecord &record = contents_.shapes[hit->shape.value];
        if (record.insideMedium == record.outsideMedium) continue;
        const Material *material = record.material ? contents_.materials[record.material.value].get() : nullptr;
        if (!material || !material->IsInterface()) continue;
        return InterfaceAt(*hit, ray);
    }
}

bool Scene::Occluded(const Ray &ray, PassedHits *passed) const {
    RenderCounters &counters = ThreadCounters();
    ++counters.shadowRays;
    bool blocked = contents_.accel->Occluded(ray, passed);
    counters.shadowRaysBlocked += blocked;
    return blocked;
}

}  // namespace pbrt
