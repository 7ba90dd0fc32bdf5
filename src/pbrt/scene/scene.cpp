#include "pbrt/scene/scene.h"

#include <type_traits>

#include "pbrt/core/counters.h"
#include "pbrt/core/error.h"

namespace pbrt {

Scene::Scene(SceneContents contents) : contents_(std::move(contents)), bounds_(contents_.accel->Bounds()) {
    PBRT_CHECK(contents_.lights != nullptr);
    for (const MaterialPtr &m : contents_.materials) {
        if (!m) continue;
        hasSubsurface_ |= m->HasBssrdf();
        needsFootprints_ |= m->NeedsFootprint();
    }
    hasMedia_ = bool(contents_.cameraMedium);
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
        // Reservoir sampling: the n-th crossing replaces the kept one with probability 1/n; u is rescaled to be uniform
        // again.
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
    return TransformSurface(t, shape.SurfaceOnRay(hit.primitive, hit.hit, local));
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
