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

}  // namespace pbrt
