#pragma once
#include "pbrt/scene/scene.h"

namespace pbrt {

/// BSDF at a hit, with normal maps applied to the shading frame; empty (false) where the surface does not scatter.
/// Needs a footprint if the material's textures filter. May terminate secondary wavelengths.
inline Bsdf ComputeBsdf(const Scene &scene, SurfacePoint &point, SampledWavelengths &lambda) {
    if (!point.material) return {};
    const Material *material = &scene.MaterialOf(point.material);
    if (material->IsPlain()) [[likely]]
        return material->GetBsdf(point, lambda);
    material = material->Resolve(point);
    if (!material || material->IsInterface()) return {};
    material->PerturbShading(point);
    return material->GetBsdf(point, lambda);
}

/// Cheap, conservative test that ComputeBsdf is not empty; true for most surfaces.
inline bool ScattersSurely(const Scene &scene, const SurfacePoint &point) {
    return point.material && scene.MaterialOf(point.material).IsPlain();
}

/// Subsurface scattering at a point with a BSDF; empty if its material has none.
inline std::optional<Bssrdf> ComputeBssrdf(const Scene &scene, const SurfacePoint &point,
                                           const SampledWavelengths &lambda) {
    const Material *material = scene.MaterialOf(point.material).Resolve(point);
    return material->GetBssrdf(point, lambda);
}

/// Radiance emitted back along the ray (area lights).
inline SampledSpectrum EmittedRadiance(const Scene &scene, const SurfacePoint &point,
                                       const SampledWavelengths &lambda) {
    if (!point.light) return SampledSpectrum(0);
    return scene.Lights()[point.light].L(point.p, point.n, point.uv, point.wo, lambda);
}

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
