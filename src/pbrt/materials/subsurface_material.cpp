#include "pbrt/materials/material_params.h"

namespace pbrt {
namespace {

/// Medium below a surface: absorption and reduced scattering or, if `isReflectance`, the reflectance of a uniformly lit
/// half space of the medium and its mean free path.
struct SubsurfaceMatter {
    SpectrumInput first, second;
    bool isReflectance = false;
};

class SubsurfaceMaterial final : public SurfaceMaterial {
  public:
    /// `scale` multiplies coefficients or, if they were not given, the mean free path (as in stock).
    SubsurfaceMaterial(SubsurfaceMatter matter, Float scale, RoughnessInput roughness,
                       std::shared_ptr<const SubsurfaceTable> table)
        : matter_(std::move(matter)), scale_(scale), roughness_(std::move(roughness)), table_(std::move(table)) {}
    Bsdf GetBsdf(const SurfacePoint &point, SampledWavelengths &) const override {
        return Bsdf(point.shading.n, point.shading.dpdu, DielectricBxdf(table_->Eta(), roughness_(point)));
    }
    bool HasBssrdf() const override { return true; }
    std::optional<Bssrdf> GetBssrdf(const SurfacePoint &point, const SampledWavelengths &lambda) const override {
        SampledSpectrum first = matter_.first(point, lambda),
                        second = ClampZero(scale_ * matter_.second(point, lambda));
        if (!matter_.isReflectance) return MakeBssrdf(point, ClampZero(scale_ * first), second, lambda);
        first = Clamp(first, 0, 1);
        SampledSpectrum sigmaA, sigmaS;
        for (int i = 0; i < SpectrumSamples; ++i) {
            const Float albedo = table_->AlbedoOf(first[i]);
            const Float sigmaT = 1 / std::max(second[i], Float(1e-8));
            sigmaS[i] = albedo * sigmaT;
            sigmaA[i] = (1 - albedo) * sigmaT;
        }
        return MakeBssrdf(point, sigmaA, sigmaS, lambda);
    }

  private:
    Bssrdf MakeBssrdf(const SurfacePoint &point, const SampledSpectrum &sigmaA, const SampledSpectrum &sigmaS,
                      const SampledWavelengths &lambda) const {
        return Bssrdf(point.p, point.shading.n, sigmaA, sigmaS, lambda, *table_);
    }

    SubsurfaceMatter matter_;
    Float scale_;
    RoughnessInput roughness_;
    std::shared_ptr<const SubsurfaceTable> table_;
};

struct SubsurfaceParams : RemapParams, ReliefParams {
    std::string name;
    SpectrumTextureParam sigmaA = Unbounded(), sigmaS = Unbounded(), reflectance = Albedo(), mfp = Unbounded(1);
    Float scale = 1, g = 0, eta = Float(1.33);
    RoughnessParams roughness;
    void Describe(auto &&v) {
        v("name", name, "known medium; sets absorption and scattering");
        if (v.When(name.empty())) {
            v("sigma_a", sigmaA, "absorption, without name");
            v("sigma_s", sigmaS, "reduced scattering, with sigma_a");
            if (v.When(!sigmaA && !sigmaS))
                v("reflectance", reflectance, "reflectance of the medium, without sigma_a, sigma_s");
            if (v.When(bool(reflectance))) v("mfp", mfp, "mean free path, with reflectance");
        }
        v("scale", scale, "factor of coefficients or mean free path");
        v("g", g, Range<Float>{-1, 1, true, true}, "scattering asymmetry");
        v("eta", eta, "index of refraction");
        roughness.Describe(v);
        RemapParams::Describe(v);
        ReliefParams::Describe(v);
    }
};

/// Medium by name, coefficients or reflectance; else stock's default.
SubsurfaceMatter MakeSubsurfaceMatter(const SubsurfaceParams &p, const ParamSet &set, MaterialContext &context) {
    Inputs in(context);
    if (!p.name.empty()) {
        const auto constant = [](const std::array<Float, 3> &rgb) { return ConstantSrgb({rgb[0], rgb[1], rgb[2]}); };
        std::vector<std::string> names;
        for (const ScatteringPreset &preset : EmbeddedScatteringPresets()) {
            if (preset.name == p.name) return {constant(preset.absorption), constant(preset.reducedScattering)};
            names.push_back(preset.name);
        }
        throw set.Error("name", "there is no medium \"{}\"; {}.", Abbreviate(p.name), ListChoices(p.name, names));
    }
    if (!p.sigmaA != !p.sigmaS)
        throw set.Error(p.sigmaA ? "sigma_a" : "sigma_s", "\"sigma_a\" and \"sigma_s\" must be given together.");
    if (p.sigmaA) return {in(p.sigmaA), in(p.sigmaS)};
    if (p.reflectance) return {in(p.reflectance), in(p.mfp), true};
    return {ConstantSrgb({Float(.0011), Float(.0024), Float(.014)}),
            ConstantSrgb({Float(2.55), Float(3.21), Float(3.77)})};
}

}  // namespace

void AddSubsurface(MaterialTable &table) {
    AddSurface<SubsurfaceParams>(
        table, "subsurface",
        "scatters light below the surface with volpath only, as in stock; **differs** a little: "
        "[departures](#departures)",
        [](const SubsurfaceParams &p, const ParamSet &set, MaterialContext &context) {
            SubsurfaceMatter matter = MakeSubsurfaceMatter(p, set, context);
            Float g = p.g;
            if (g != 0 && !p.name.empty()) {
                set.Warn(context.sink, "g", "\"g\" has no effect beside \"name\".");
                g = 0;
            }
            CheckIndex(set, "eta", ConstantSpectrum(p.eta));
            return std::make_shared<SubsurfaceMaterial>(std::move(matter), p.scale, p.roughness.Make(context, p.remap),
                                                        SubsurfaceTable::Shared(g, p.eta));
        });
}

}  // namespace pbrt
