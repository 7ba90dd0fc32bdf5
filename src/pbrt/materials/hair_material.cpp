#include "pbrt/materials/hair_material.h"

#include "pbrt/textures/basic_textures.h"

namespace pbrt {

namespace {

/// Absorption of pigments in hair (sRGB): d'Eon et al. 2011.
Rgb AbsorptionOfPigments(Float eumelanin, Float pheomelanin) {
    const Float e = std::max(Float(0), eumelanin), p = std::max(Float(0), pheomelanin);
    return {e * 0.419f + p * 0.187f, e * 0.697f + p * 0.4f, e * 1.37f + p * 1.05f};
}

}  // namespace

HairColor HairColor::Pigments(FloatInput eumelanin, FloatInput pheomelanin) {
    if (!eumelanin.IsConstant() || !pheomelanin.IsConstant())
        return HairColor(ByPigments{std::move(eumelanin), std::move(pheomelanin)});
    auto same = std::make_shared<RgbUnboundedSpectrum>(ColorSpace::SRGB(),
                                                       AbsorptionOfPigments(eumelanin({}), pheomelanin({})));
    return Absorption(SpectrumInput(std::make_shared<ConstantSpectrumTexture>(std::move(same))));
}

SampledSpectrum HairColor::operator()(const SurfacePoint &point, Float betaN, const SampledWavelengths &lambda) const {
    if (auto *way = std::get_if<ByAbsorption>(&way_)) return ClampZero(way->sigmaA(point, lambda));
    if (auto *way = std::get_if<ByReflectance>(&way_))
        return HairBxdf::AbsorptionOfReflectance(Clamp(way->reflectance(point, lambda), 0, 1), betaN);
    const ByPigments &pigments = *std::get_if<ByPigments>(&way_);
    const Rgb rgb = AbsorptionOfPigments(pigments.eumelanin(point), pigments.pheomelanin(point));
    return RgbUnboundedSpectrum(ColorSpace::SRGB(), rgb).Sample(lambda);
}

Bsdf HairMaterial::GetBsdf(const SurfacePoint &point, SampledWavelengths &lambda) const {
    // Roughnesses below 0.01 exceed single precision.
    const Float betaM = std::clamp(betaM_(point), Float(0.01), Float(1));
    const Float betaN = std::clamp(betaN_(point), Float(0.01), Float(1));
    return MakeBsdf(
        point, HairBxdf(2 * point.uv.y - 1, eta_(point), color_(point, betaN, lambda), betaM, betaN, alpha_(point)));
}

}  // namespace pbrt
