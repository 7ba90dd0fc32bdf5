#include "pbrt/accel/embree_callbacks.h"

#include "pbrt/math/rng.h"

namespace pbrt {
namespace {

const QueryContext &QueryOf(const RTCIntersectContext *context) {
    return *reinterpret_cast<const QueryContext *>(context);
}

/// Stochastic alpha test. Depends only on the query's ray and the hit's identity, so closest-hit and occlusion queries
/// agree, and layers along one ray are independent.
bool StopsRay(const Geometry &g, const RTCIntersectContext *context, const RTCRay &localRay, uint32_t primitive,
              const PrimitiveHit &hit) {
    Float alpha;
    if (g.constantAlpha) {
        alpha = *g.constantAlpha;
    } else {
        const Ray local{{localRay.org_x, localRay.org_y, localRay.org_z},
                        {localRay.dir_x, localRay.dir_y, localRay.dir_z}};
        TextureContext at;
        at.p = g.renderFromShape.Point(local(hit.t));
        at.uv = g.shape->Uv(primitive, g.shape->Completed(primitive, hit, local));
        alpha = g.alpha->Evaluate(at);
    }
    if (alpha >= 1) return true;
    if (alpha <= 0) return false;
    const Ray &ray = *QueryOf(context).ray;
    Float u = g.hitsOnce ? 0 : hit.u, v = g.hitsOnce ? 0 : hit.v;
    return HashFloat(ray.o, ray.d, g.id.value, primitive, context->instID[0], u, v) <= alpha;
}

/// The hit in the query's terms, except for the instance, which is still Embree's id.
AccelHit Report(const Geometry &g, const RTCIntersectContext *context, uint32_t primitive, const PrimitiveHit &hit) {
    return {g.id, primitive, hit, int32_t(context->instID[0])};
}

void IgnoreHit(const RTCFilterFunctionNArguments *args) { args->valid[0] = 0; }

void CollectHit(const RTCFilterFunctionNArguments *args) {
    if (args->valid[0] == 0) return;
    args->valid[0] = 0;
    PassedHits *passed = QueryOf(args->context).passed;
    if (!passed) return;
    const Geometry &g = *static_cast<const Geometry *>(args->geometryUserPtr);
    const RTCRay &ray = *reinterpret_cast<const RTCRay *>(args->ray);
    const RTCHit &hit = *reinterpret_cast<const RTCHit *>(args->hit);
    const PrimitiveHit at{ray.tfar, hit.u, hit.v};
    if (g.alpha && !StopsRay(g, args->context, ray, hit.primID, at)) return;
    passed->Add(Report(g, args->context, hit.primID, at));
}

/// Nearest hit beyond tMin that stops the ray, through Shape::Intersect.
std::optional<PrimitiveHit> NearestHit(const Geometry &g, const RTCIntersectContext *context, const RTCRay &ray,
                                       uint32_t primitive, Float tMin) {
    const Ray local{{ray.org_x, ray.org_y, ray.org_z}, {ray.dir_x, ray.dir_y, ray.dir_z}, ray.tfar};
    while (std::optional<PrimitiveHit> hit = g.shape->Intersect(primitive, local, tMin)) {
        if (!g.alpha || StopsRay(g, context, ray, primitive, *hit)) return hit;
        tMin = std::nextafter(hit->t, Infinity);
    }
    return {};
}

void UserOccluded(const RTCOccludedFunctionNArguments *args) {
    if (args->valid[0] == 0) return;
    const Geometry &g = *static_cast<const Geometry *>(args->geometryUserPtr);
    RTCRay &ray = *reinterpret_cast<RTCRay *>(args->ray);
    if (NearestHit(g, args->context, ray, args->primID, ray.tnear)) ray.tfar = -Infinity;
}

void NeverOccluded(const RTCOccludedFunctionNArguments *) {}

void CollectHits(const RTCOccludedFunctionNArguments *args) {
    PassedHits *passed = QueryOf(args->context).passed;
    if (args->valid[0] == 0 || !passed) return;
    const Geometry &g = *static_cast<const Geometry *>(args->geometryUserPtr);
    const RTCRay &ray = *reinterpret_cast<const RTCRay *>(args->ray);
    Float tMin = ray.tnear;
    while (std::optional<PrimitiveHit> hit = NearestHit(g, args->context, ray, args->primID, tMin)) {
        passed->Add(Report(g, args->context, args->primID, *hit));
        tMin = std::nextafter(hit->t, Infinity);
    }
}

}  // namespace

void UserBounds(const RTCBoundsFunctionArguments *args) {
    const Geometry &g = *static_cast<const Geometry *>(args->geometryUserPtr);
    Bounds3 b = g.shape->PrimitiveBounds(args->primID);
    // Hits are computed in double precision, box tests in float.
    Vector3 margin = Gamma(8) * Max(Abs(b.low), Abs(b.high));
    Point3 low = b.low - margin, high = b.high + margin;
    *args->bounds_o = {low.x, low.y, low.z, 0, high.x, high.y, high.z, 0};
}

void UserIntersect(const RTCIntersectFunctionNArguments *args) {
    if (args->valid[0] == 0) return;
    const Geometry &g = *static_cast<const Geometry *>(args->geometryUserPtr);
    RTCRayHit &query = *reinterpret_cast<RTCRayHit *>(args->rayhit);
    std::optional<PrimitiveHit> hit = NearestHit(g, args->context, query.ray, args->primID, query.ray.tnear);
    if (!hit) return;
    query.ray.tfar = hit->t;
    query.hit.u = hit->u;
    query.hit.v = hit->v;
    query.hit.Ng_x = query.hit.Ng_y = query.hit.Ng_z = 0;  // not used
    query.hit.primID = args->primID;
    query.hit.geomID = args->geomID;
    query.hit.instID[0] = args->context->instID[0];
}

void AlphaFilter(const RTCFilterFunctionNArguments *args) {
    if (args->valid[0] == 0) return;
    const Geometry &g = *static_cast<const Geometry *>(args->geometryUserPtr);
    const RTCRay &ray = *reinterpret_cast<const RTCRay *>(args->ray);
    const RTCHit &hit = *reinterpret_cast<const RTCHit *>(args->hit);
    if (!StopsRay(g, args->context, ray, hit.primID, {ray.tfar, hit.u, hit.v})) args->valid[0] = 0;
}

ShadowCallbacks CallbacksFor(ShadowRays what, bool hasAlpha) {
    switch (what) {
        case ShadowRays::Blocked: return {hasAlpha ? AlphaFilter : nullptr, UserOccluded};
        case ShadowRays::Passed: return {IgnoreHit, NeverOccluded};
        case ShadowRays::Collected: return {CollectHit, CollectHits};
    }
    return {};
}

}  // namespace pbrt
