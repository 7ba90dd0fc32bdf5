#pragma once
#include <embree3/rtcore.h>

#include <optional>

#include "pbrt/accel/accel.h"

namespace pbrt {

enum class ShadowRays {
    Blocked,
    Passed,
    Collected,  ///< they pass, and the query collects the hits
};

struct Geometry {
    const Shape *shape = nullptr;
    ShapeId id{};
    const FloatTexture *alpha = nullptr;  ///< null: opaque
    Transform renderFromShape{};          ///< for the positions where alpha is evaluated
    std::optional<Float> constantAlpha;
    bool hitsOnce = false;  ///< a straight line hits each primitive at most once
};

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
void AlphaFilter(const RTCFilterFunctionNArguments *args);

struct ShadowCallbacks {
    RTCFilterFunctionN filter;          ///< for Embree's own primitives; may be null
    RTCOccludedFunctionN userGeometry;  ///< for all others
};
ShadowCallbacks CallbacksFor(ShadowRays what, bool hasAlpha);

}  // namespace pbrt
