#pragma once
#include "pbrt/cameras/camera.h"
#include "pbrt/math/ray.h"
#include "pbrt/shapes/surface_point.h"

namespace pbrt {

/// Fills the texture filter footprint of a surface point: from the ray's differentials (intersected with the tangent
/// plane) if it has them, else from the camera's approximation.
void ComputeFootprint(SurfacePoint &point, const RayDifferential &differential, const Camera &camera,
                      int samplesPerPixel);

/// Differentials of the ray that leaves `point` towards wi after a perfectly specular reflection (eta = 1) or
/// transmission (eta = index ratio of the sample) of a ray that arrived with `arrived` (Igehy 1999, sections 3.1.2 and
/// 3.1.3). Invalid if they become too large.
RayDifferential ReflectDifferential(const SurfacePoint &point, const RayDifferential &arrived, const Vector3 &wi);
RayDifferential TransmitDifferential(const SurfacePoint &point, const RayDifferential &arrived, const Vector3 &wi,
                                     Float eta);

}  // namespace pbrt
