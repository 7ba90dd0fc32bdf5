#include "pbrt/materials/subsurface_material.h"

namespace pbrt {

SubsurfaceMatter::Sigmas SubsurfaceMatter::At(const SurfacePoint &point, const SampledWavelengths &lambda, Float scale,
                                              const SubsurfaceTable &table) const {
    if (auto *way = std::get_if<ByCoefficients>(&way_))
        return {ClampZero(scale * way->sigmaA(point, lambda)), ClampZero(scale * way->sigmaS(point, lambda))};
    const ByReflectance &way = *std::get_if<ByReflectance>(&way_);
    const SampledSpectrum reflectance = Clamp(way.reflectance(point, lambda), 0, 1);
    const SampledSpectrum meanFreePath = ClampZero(scale * way.meanFreePath(point, lambda));
    Sigmas sigmas;
    for (int i = 0; i < SpectrumSamples; ++i) {
        const Float albedo = table.AlbedoOf(reflectance[i]);
        const Float sigmaT = 1 / std::max(meanFreePath[i], Float(1e-8));
        sigmas.s[i] = albedo * sigmaT;
        sigmas.a[i] = (1 - albedo) * sigmaT;
    }
    return sigmas;
}

std::optional<Bssrdf> SubsurfaceMaterial::GetBssrdf(const SurfacePoint &point, const SampledWavelengths &lambda) const {
    const SubsurfaceMatter::Sigmas sigmas = matter_.At(point, lambda, scale_, *table_);
    return Bssrdf(point.p, point.shading.n, sigmas.a, sigmas.s, lambda, *table_);
}

}  // namespace pbrt
