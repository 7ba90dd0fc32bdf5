#pragma once
#include "pbrt/scene/scene.h"

namespace pbrt {

/// The BSDF at a hit, its shading frame perturbed by normal maps; empty (false) where the surface does not scatter.
/// Needs the footprint filled if the material's textures filter. May terminate secondary wavelengths.
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

/// True only if ComputeBsdf is not empty there; a cheap test that covers most surfaces.
inline bool ScattersSurely(const Scene &scene, const SurfacePoint &point) {
    return point.material && scene.MaterialOf(point.material).IsPlain();
}

/// Where light that crosses the surface at a hit comes out again; empty if light is not scattered below the surface.
inline std::optional<Bssrdf> ComputeBssrdf(const Scene &scene, const SurfacePoint &point,
                                           const SampledWavelengths &lambda) {
    const Material *material = scene.MaterialOf(point.material).Resolve(point);
    return material->GetBssrdf(point, lambda);
}

/// Radiance the surface emits back along the ray (area lights).
inline SampledSpectrum EmittedRadiance(const Scene &scene, const SurfacePoint &point,
                                       const SampledWavelengths &lambda) {
    if (!point.light) return SampledSpectrum(0);
    return scene.Lights()[point.light].L(point.p, point.n, point.uv, point.wo, lambda);
}

}  // namespace pbrt
