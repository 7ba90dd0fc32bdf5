#pragma once
#include <embree3/rtcore.h>

#include <optional>

#include "pbrt/accel/passed_hits.h"
#include "pbrt/textures/texture.h"

namespace pbrt {

/// Treatment of shadow rays at a shape.
enum class ShadowRays {
    Blocked,
    Passed,
    Collected,  ///< they pass, and the query collects the hits
};

/// Geometry data for Embree's callbacks.
struct Geometry {
    const Shape *shape = nullptr;
    ShapeId id{};
    const FloatTexture *alpha = nullptr;  ///< null: opaque
    Transform renderFromShape{};          ///< for the positions where alpha is evaluated
    std::optional<Float> constantAlpha;
    bool hitsOnce = false;  ///< a straight line hits each primitive at most once
};

/// Passed to every callback by Embree.
struct QueryContext {
    RTCIntersectContext base;
    const Ray *ray;      ///< the ray of the query, before any instance transform
    PassedHits *passed;  ///< null: not requested
    explicit QueryContext(const Ray &r, PassedHits *p = nullptr) : ray(&r), passed(p) {
        rtcInitIntersectContext(&base);
        base.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    }
};

/// Bounds and closest hits of user geometries, through Shape.
void UserBounds(const RTCBoundsFunctionArguments *args);
void UserIntersect(const RTCIntersectFunctionNArguments *args);
/// Alpha test of closest-hit queries.
void AlphaFilter(const RTCFilterFunctionNArguments *args);

/// Callbacks of occlusion queries for a geometry.
struct ShadowCallbacks {
    RTCFilterFunctionN filter;          ///< for Embree's own primitives; may be null
    RTCOccludedFunctionN userGeometry;  ///< for all others
};
ShadowCallbacks CallbacksFor(ShadowRays what, bool hasAlpha);

}  // namespace pbrt
