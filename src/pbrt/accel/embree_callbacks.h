#pragma once
#include <embree3/rtcore.h>

#include <optional>

#include "pbrt/accel/passed_hits.h"
#include "pbrt/textures/texture.h"

namespace pbrt {

/// What happens to shadow rays at a shape.
enum class ShadowRays {
    Blocked,
    Passed,
    Collected,  ///< they pass, and the query collects the hits
};

/// The data of a geometry for Embree's callbacks.
struct Geometry {
    const Shape *shape = nullptr;
    ShapeId id{};
    const FloatTexture *alpha = nullptr;  ///< null: opaque
    Transform renderFromShape{};          ///< for the positions at which alpha is evaluated
    std::optional<Float> constantAlpha;
    bool hitsOnce = false;  ///< a straight line meets each primitive at most once
};

/// Embree hands this back in every callback.
struct QueryContext {
    RTCIntersectContext base;
    const Ray *ray;      ///< the ray of the query, before any instance transform
    PassedHits *passed;  ///< null: not asked for
    explicit QueryContext(const Ray &r, PassedHits *p = nullptr) : ray(&r), passed(p) {
        rtcInitIntersectContext(&base);
        base.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    }
};

/// Bounds and closest hits of geometries whose primitives are not Embree's own, through Shape.
void UserBounds(const RTCBoundsFunctionArguments *args);
void UserIntersect(const RTCIntersectFunctionNArguments *args);
/// Lets closest-hit queries through where the alpha texture does.
void AlphaFilter(const RTCFilterFunctionNArguments *args);

/// What occlusion queries do at a geometry.
struct ShadowCallbacks {
    RTCFilterFunctionN filter;          ///< for Embree's own primitives; may be null
    RTCOccludedFunctionN userGeometry;  ///< for all others
};
ShadowCallbacks CallbacksFor(ShadowRays what, bool hasAlpha);

}  // namespace pbrt
