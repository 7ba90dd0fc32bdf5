#include "pbrt/materials/material_params.h"

namespace pbrt {
namespace {

struct HairParams {
    SpectrumTextureParam sigmaA = Unbounded(), reflectance = Albedo(), color = Albedo();
    FloatTextureParam eumelanin{}, pheomelanin{};
    FloatTextureParam eta{Float(1.55)}, betaM{Float(0.3)}, betaN{Float(0.3)}, alpha{2};
    void Describe(auto &&v) {
        v("sigma_a", sigmaA, "absorption");
        v("reflectance", reflectance, "reflectance of a mass of hair, without sigma_a");
        if (v.When(!reflectance)) v("color", color, "the same as reflectance");
        v("eumelanin", eumelanin, "dark pigment, without a colour; default without pheomelanin: 1.3");
        v("pheomelanin", pheomelanin, "red pigment, without a colour");
        v("eta", eta, "index of refraction");
        v("beta_m", betaM, "roughness along the fibre, 0 to 1");
        v("beta_n", betaN, "roughness around the fibre, 0 to 1");
        v("alpha", alpha, "scale angle, in degrees");
    }
};

struct HairShape {
    FloatInput eta, betaM, betaN, alpha;
};

/// Hair in the near field; the offset across the fibre is the surface parameter v. `absorption(point, betaN, lambda)`:
/// per fibre radius.
std::shared_ptr<SurfaceMaterial> MakeFibre(const HairShape &shape, auto absorption) {
    return MakeLobeMaterial([=](const SurfacePoint &point, SampledWavelengths &lambda) {
        // Roughnesses below 0.01 exceed single precision.
        const Float betaM = std::clamp(shape.betaM(point), Float(0.01), Float(1));
        const Float betaN = std::clamp(shape.betaN(point), Float(0.01), Float(1));
        const Float eta = std::max(shape.eta(point), Float(0));
        return HairBxdf(2 * point.uv.y - 1, eta, absorption(point, betaN, lambda), betaM, betaN, shape.alpha(point));
    });
}

/// Absorption of pigments in hair (sRGB): d'Eon et al. 2011. Negative concentrations count as 0.
Rgb AbsorptionOfPigments(Float eumelanin, Float pheomelanin) {
    const Float e = std::max(Float(0), eumelanin), p = std::max(Float(0), pheomelanin);
    return {e * 0.419f + p * 0.187f, e * 0.697f + p * 0.4f, e * 1.37f + p * 1.05f};
}

/// Colour by sigma_a, reflectance or pigments: the first given applies, the others cause a warning.
std::shared_ptr<SurfaceMaterial> MakeHair(const HairParams &p, const ParamSet &set, MaterialContext &context) {
    Inputs in(context);
    FloatTexturePtr eta = in.Note(context.textures.Get(p.eta));
    if (auto constant = eta->Constant()) CheckIndex(set, "eta", ConstantSpectrum(*constant));
    const HairShape shape{FloatInput(std::move(eta)), in(p.betaM), in(p.betaN), in(p.alpha)};

    const SpectrumTextureParam &reflectance = p.reflectance ? p.reflectance : p.color;
    const char *reflectanceName = p.reflectance ? "reflectance" : "color";
    const char *used = p.sigmaA ? "sigma_a" : reflectance ? reflectanceName : nullptr;
    auto ignore = [&](bool given, const char *name) {
        if (used && given) set.Warn(context.sink, name, fmt::format("\"{}\" has no effect beside \"{}\".", name, used));
    };
    if (p.sigmaA) ignore(bool(reflectance), reflectanceName);
    ignore(bool(p.eumelanin), "eumelanin");
    ignore(bool(p.pheomelanin), "pheomelanin");

    const auto byAbsorption = [&](const SpectrumInput &sigmaA) {
        return MakeFibre(shape, [sigmaA](const SurfacePoint &point, Float, const SampledWavelengths &lambda) {
            return ClampZero(sigmaA(point, lambda));
        });
    };
    if (p.sigmaA) return byAbsorption(in(p.sigmaA));
    if (reflectance)
        return MakeFibre(
            shape, [color = in(reflectance)](const SurfacePoint &point, Float betaN, const SampledWavelengths &lambda) {
                return HairBxdf::AbsorptionOfReflectance(Clamp(color(point, lambda), 0, 1), betaN);
            });
    const bool none = !p.eumelanin && !p.pheomelanin;
    const FloatInput eumelanin = p.eumelanin ? in(p.eumelanin) : FloatInput(none ? Float(1.3) : Float(0));
    const FloatInput pheomelanin = p.pheomelanin ? in(p.pheomelanin) : FloatInput(Float(0));
    if (eumelanin.IsConstant() && pheomelanin.IsConstant())
        return byAbsorption(ConstantSrgb(AbsorptionOfPigments(eumelanin({}), pheomelanin({}))));
    return MakeFibre(shape, [=](const SurfacePoint &point, Float, const SampledWavelengths &lambda) {
        const Rgb rgb = AbsorptionOfPigments(eumelanin(point), pheomelanin(point));
        return RgbUnboundedSpectrum(ColorSpace::SRGB(), rgb).Sample(lambda);
    });
}

}  // namespace

void AddHair(MaterialTable &table) { AddSurface<HairParams>(table, "hair", "", MakeHair); }

}  // namespace pbrt
