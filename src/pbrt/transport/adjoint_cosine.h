#pragma once
#include "pbrt/shapes/surface_point.h"

namespace pbrt {

/// The cosine for light that comes from `wo` and is scattered towards `wi` on a path that begins at a light. Camera
/// paths use the cosine at the shading normal. For both kinds of paths to make the same picture, light paths use the
/// cosine at the geometric normal, times the ratio of both cosines on the side that the light comes from (Veach 1997,
/// section 5.3.2).
inline Float AdjointCosine(const SurfacePoint &point, const Vector3 &wo, const Vector3 &wi) {
    const Float geometric = AbsDot(wo, point.n);
    return geometric > 0 ? AbsDot(wo, point.shading.n) * AbsDot(wi, point.n) / geometric : 0;
}

}  // namespace pbrt
