#pragma once
#include "pbrt/cameras/camera.h"
#include "pbrt/math/ray.h"
#include "pbrt/shapes/surface_point.h"

namespace pbrt {

/// Computes the texture filter footprint: from ray differentials (intersected with the tangent plane) if present, else
/// from the camera's approximation.
void ComputeFootprint(SurfacePoint &point, const RayDifferential &differential, const Camera &camera,
                      int samplesPerPixel);

/// Ray differentials towards wi after perfect specular scattering of a ray with differentials `arrived` (Igehy 1999,
/// sections 3.1.2 and 3.1.3). eta: 1 for reflection, the sample's index ratio for transmission. Invalid if too large.
RayDifferential ReflectDifferential(const SurfacePoint &point, const RayDifferential &arrived, const Vector3 &wi);
RayDifferential TransmitDifferential(const SurfacePoint &point, const RayDifferential &arrived, const Vector3 &wi,
                                     Float eta);

}  // namespace pbrt
