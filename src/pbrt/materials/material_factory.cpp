#include "pbrt/materials/material_factory.h"

#include <algorithm>

#include "pbrt/core/limits.h"
#include "pbrt/materials/coated_materials.h"
#include "pbrt/materials/conductor_material.h"
#include "pbrt/materials/diffuse_materials.h"
#include "pbrt/materials/hair_material.h"
#include "pbrt/materials/measured_material.h"
#include "pbrt/materials/mix_material.h"
#include "pbrt/materials/subsurface_material.h"
#include "pbrt/math/rng.h"
#include "pbrt/spectra/spectral_data.h"
#include "pbrt/textures/basic_textures.h"

namespace pbrt {

namespace {

/// Creates the inputs of one material and records in the context whether they use filter footprints.
class Inputs {
  public:
    explicit Inputs(MaterialContext &context) : context_(context) {}
    FloatInput operator()(const FloatTextureParam &p) { return FloatInput(Note(context_.textures.Get(p))); }
    SpectrumInput operator()(const SpectrumTextureParam &p) { return SpectrumInput(Note(context_.textures.Get(p))); }
    template <class Ptr>
    Ptr Note(Ptr texture) {
        context_.usesFootprint |= texture->UsesFootprint();
        return texture;
    }

  private:
    MaterialContext &context_;
};

SpectrumTextureParam Albedo(std::optional<Float> value = {}) { return {{SpectrumUse::Albedo, value}}; }
SpectrumTextureParam Unbounded(std::optional<Float> value = {}, const char *named = nullptr) {
    return {{SpectrumUse::Unbounded, value, named}};
}

/// Throws on an invalid index of refraction: a dielectric's must be positive, a metal's >= 0, and none above kMaxIndex,
/// whose square is finite. Tables may be 0, as beyond their ends, where stock uses 1.
void CheckIndex(const ParamSet &set, const std::string &name, const Spectrum &eta, bool isMetal = false) {
    Float low = Infinity, high = -Infinity;
    for (Float nm = LambdaMin; nm <= LambdaMax; ++nm) {
        low = std::min(low, eta(nm));
        high = std::max(high, eta(nm));
    }
    const bool isTable = !dynamic_cast<const ConstantSpectrum *>(&eta);
    constexpr Float kMaxIndex = 1e6f;
    if (high > kMaxIndex)
        throw set.Error(name, fmt::format("\"{}\" is {}; it must be at most {}.", name, high, kMaxIndex));
    if (low >= 0 && (isMetal || isTable || high > 0)) return;
    throw set.Error(name, fmt::format("\"{}\" {} {}; it must {}.", name, low == high ? "is" : "goes down to", low,
                                      isMetal ? "not be negative" : "be positive"));
}

struct IndexParams {
    SpectrumParam eta{SpectrumUse::Unbounded, Float(1.5), nullptr, true};
    std::string name = "eta";
    template <class V>
    void Describe(V &&v) {
        v(name, eta, "index of refraction");
    }
    IndexInput Make(const ParamSet &set, const MaterialContext &context) const {
        SpectrumPtr spectrum = eta.Make(context.files);
        CheckIndex(set, name, *spectrum);
        return IndexInput(std::move(spectrum));
    }
};

struct RoughnessParams {
    std::string prefix{};
    FloatTextureParam both{0}, u{}, v{};
    template <class V>
    void Describe(V &&visit) {
        constexpr Range<Float> kRange{0, 1e6f};
        visit(prefix + "uroughness", u, kRange, "roughness along u");
        visit(prefix + "vroughness", v, kRange, "roughness along v");
        if (visit.When(!u || !v))
            visit(prefix + "roughness", both, kRange, "roughness along u and v where none is given");
    }
    RoughnessInput Make(MaterialContext &context, bool remap) const {
        Inputs in(context);
        return {in(u ? u : both), in(v ? v : both), remap};
    }
};

struct RemapParams {
    bool remap = true;
    template <class V>
    void Describe(V &&v) {
        v("remaproughness", remap,
          "the distribution's alpha is the square root of the roughness; false: it is the roughness");
    }
};

struct MetalParams {
    std::string prefix{};
    SpectrumTextureParam eta = Unbounded({}, "metal-Cu-eta"), k = Unbounded({}, "metal-Cu-k"), reflectance = Albedo();
    template <class V>
    void Describe(V &&v) {
        v(prefix + "eta", eta, "index of refraction");
        v(prefix + "k", k, "imaginary part of the index: absorption");
        v("reflectance", reflectance, "reflectance of the metal at normal incidence, instead of eta and k");
    }
    MetalInput Make(const ParamSet &set, MaterialContext &context) const {
        Inputs in(context);
        if (reflectance && (eta || k))
            throw set.Error("reflectance", fmt::format("\"reflectance\" and \"{}{}\" cannot both be given.", prefix,
                                                       eta ? "eta" : "k"));
        if (reflectance) return MetalInput(in(reflectance));
        auto checked = [&](const SpectrumTextureParam &p, const char *name) {
            SpectrumTexturePtr texture = in.Note(context.textures.Get(p));
            if (p && texture->Constant()) CheckIndex(set, prefix + name, *texture->Constant(), true);
            return SpectrumInput(std::move(texture));
        };
        SpectrumInput first = checked(eta, "eta");
        return MetalInput(std::move(first), checked(k, "k"));
    }
};

struct ReliefParams {
    std::string normalMap;
    FloatTextureParam displacement{};
    template <class V>
    void Describe(V &&v) {
        v("displacement", displacement, "heights of a bump map, in world units");
        v("normalmap", normalMap, "an image of normals; displacement has no effect beside it");
    }
};

struct DiffuseParams : ReliefParams {
    SpectrumTextureParam reflectance = Albedo(Float(0.5));
    template <class V>
    void Describe(V &&v) {
        v("reflectance", reflectance, "albedo");
        ReliefParams::Describe(v);
    }
};

/// `prefix` applies to the coat's roughness and index only.
struct CoatParams : RemapParams, ReliefParams {
    RoughnessParams roughness;
    IndexParams index;
    FloatTextureParam thickness{Float(0.01)}, g{0};
    SpectrumTextureParam albedo = Albedo(0);
    int maxDepth = 10, samples = 1;
    explicit CoatParams(const std::string &prefix) : roughness{prefix} { index.name = prefix + "eta"; }
    template <class V>
    void Describe(V &&v) {
        roughness.Describe(v);
        index.Describe(v);
        v("thickness", thickness, "optical thickness of the coat along its normal");
        v("albedo", albedo, "single-scattering albedo of the medium in the coat; 0: the medium only absorbs");
        v("g", g, "asymmetry of the medium's scattering");
        v("maxdepth", maxDepth, Range<int>{0, 1 << 16}, "largest number of scattering events in the coat");
        v("nsamples", samples, Range<int>{1, 1 << 16}, "random walks for each evaluation");
        RemapParams::Describe(v);
        ReliefParams::Describe(v);
    }
    CoatInput Coat(const ParamSet &set, MaterialContext &context) const {
        Inputs in(context);
        return {roughness.Make(context, remap),
                index.Make(set, context),
                in(thickness),
                in(albedo),
                in(g),
                maxDepth,
                samples};
    }
};

struct CoatedDiffuseParams : CoatParams {
    SpectrumTextureParam reflectance = Albedo(Float(0.5));
    CoatedDiffuseParams() : CoatParams("") {}
    template <class V>
    void Describe(V &&v) {
        v("reflectance", reflectance, "albedo below the coat");
        CoatParams::Describe(v);
    }
};

struct CoatedConductorParams : CoatParams {
    MetalParams metal{"conductor."};
    RoughnessParams metalRoughness{"conductor."};
    CoatedConductorParams() : CoatParams("interface.") {}
    template <class V>
    void Describe(V &&v) {
        metal.Describe(v);
        metalRoughness.Describe(v);
        CoatParams::Describe(v);
    }
};

struct ConductorParams : RemapParams, ReliefParams {
    MetalParams metal;
    RoughnessParams roughness;
    template <class V>
    void Describe(V &&v) {
        metal.Describe(v);
        roughness.Describe(v);
        RemapParams::Describe(v);
        ReliefParams::Describe(v);
    }
};

struct DielectricParams : RemapParams, ReliefParams {
    IndexParams index;
    RoughnessParams roughness;
    template <class V>
    void Describe(V &&v) {
        index.Describe(v);
        roughness.Describe(v);
        RemapParams::Describe(v);
        ReliefParams::Describe(v);
    }
};

struct ThinDielectricParams : ReliefParams {
    IndexParams index;
    template <class V>
    void Describe(V &&v) {
        index.Describe(v);
        ReliefParams::Describe(v);
    }
};

struct DiffuseTransmissionParams : ReliefParams {
    SpectrumTextureParam reflectance = Albedo(Float(0.25)), transmittance = Albedo(Float(0.25));
    Float scale = 1;
    template <class V>
    void Describe(V &&v) {
        v("reflectance", reflectance, "share of the light that is reflected");
        v("transmittance", transmittance, "share of the light that is transmitted");
        v("scale", scale, "factor of reflectance and transmittance");
        ReliefParams::Describe(v);
    }
};

struct HairParams {
    SpectrumTextureParam sigmaA = Unbounded(), reflectance = Albedo(), color = Albedo();
    FloatTextureParam eumelanin{}, pheomelanin{};
    FloatTextureParam eta{Float(1.55)}, betaM{Float(0.3)}, betaN{Float(0.3)}, alpha{2};
    template <class V>
    void Describe(V &&v) {
        v("sigma_a", sigmaA, "absorption");
        v("reflectance", reflectance, "reflectance of a mass of hair; used if there is no sigma_a");
        if (v.When(!reflectance)) v("color", color, "the same as reflectance");
        v("eumelanin", eumelanin,
          "concentration of the dark pigment, if no colour is given; 1.3 if pheomelanin is not given either");
        v("pheomelanin", pheomelanin, "concentration of the red pigment");
        v("eta", eta, "index of refraction");
        v("beta_m", betaM, "roughness along the fibre, 0 to 1");
        v("beta_n", betaN, "roughness around the fibre, 0 to 1");
        v("alpha", alpha, "angle of the scales, in degrees");
    }
};

/// Colour by sigma_a, reflectance or pigments: the first given applies, the others cause a warning.
HairColor MakeHairColor(const HairParams &p, const ParamSet &set, MaterialContext &context) {
    Inputs in(context);
    const SpectrumTextureParam &reflectance = p.reflectance ? p.reflectance : p.color;
    const char *reflectanceName = p.reflectance ? "reflectance" : "color";
    const char *used = p.sigmaA ? "sigma_a" : reflectance ? reflectanceName : nullptr;
    auto ignore = [&](bool given, const char *name) {
        if (used && given) set.Warn(context.sink, name, fmt::format("\"{}\" has no effect beside \"{}\".", name, used));
    };
    if (p.sigmaA) ignore(static_cast<bool>(reflectance), reflectanceName);
    ignore(static_cast<bool>(p.eumelanin), "eumelanin");
    ignore(static_cast<bool>(p.pheomelanin), "pheomelanin");

    if (p.sigmaA) return HairColor::Absorption(in(p.sigmaA));
    if (reflectance) return HairColor::Reflectance(in(reflectance));
    const bool none = !p.eumelanin && !p.pheomelanin;
    return HairColor::Pigments(p.eumelanin ? in(p.eumelanin) : FloatInput(none ? Float(1.3) : Float(0)),
                               p.pheomelanin ? in(p.pheomelanin) : FloatInput(Float(0)));
}

struct MeasuredParams : ReliefParams {
    std::string filename;
    template <class V>
    void Describe(V &&v) {
        v("filename", filename, Required(), "a file of the RGL database");
        ReliefParams::Describe(v);
    }
};

SpectrumInput ConstantSrgb(const std::array<Float, 3> &rgb) {
    return SpectrumInput(std::make_shared<ConstantSpectrumTexture>(
        std::make_shared<RgbUnboundedSpectrum>(ColorSpace::SRGB(), Rgb(rgb[0], rgb[1], rgb[2]))));
}

struct SubsurfaceParams : RemapParams, ReliefParams {
    std::string name;
    SpectrumTextureParam sigmaA = Unbounded(), sigmaS = Unbounded(), reflectance = Albedo(), mfp = Unbounded(1);
    Float scale = 1, g = 0, eta = Float(1.33);
    RoughnessParams roughness;
    template <class V>
    void Describe(V &&v) {
        v("name", name, "name of a known medium, which sets absorption and scattering");
        if (v.When(name.empty())) {
            v("sigma_a", sigmaA, "absorption, if there is no name");
            v("sigma_s", sigmaS, "reduced scattering; used together with sigma_a");
            if (v.When(!sigmaA && !sigmaS))
                v("reflectance", reflectance,
                  "reflectance of the medium seen from outside, if neither sigma_a nor sigma_s is given");
            if (v.When(static_cast<bool>(reflectance))) v("mfp", mfp, "mean free path; used together with reflectance");
        }
        v("scale", scale, "factor of absorption and scattering, or of the mean free path");
        v("g", g, Range<Float>{-1, 1, true, true}, "asymmetry of the scattering");
        v("eta", eta, "index of refraction");
        roughness.Describe(v);
        RemapParams::Describe(v);
        ReliefParams::Describe(v);
    }
};

const ScatteringPreset &FindPreset(const ParamSet &set, const std::string &name) {
    std::vector<std::string> names;
    for (const ScatteringPreset &preset : EmbeddedScatteringPresets()) {
        if (preset.name == name) return preset;
        names.push_back(preset.name);
    }
    throw set.Error("name", fmt::format("there is no medium \"{}\"; {}.", Abbreviate(name), ListChoices(name, names)));
}

/// Medium by name, coefficients or reflectance; else stock's default.
SubsurfaceMatter MakeSubsurfaceMatter(const SubsurfaceParams &p, const ParamSet &set, MaterialContext &context) {
    Inputs in(context);
    if (!p.name.empty()) {
        const ScatteringPreset &preset = FindPreset(set, p.name);
        return SubsurfaceMatter::Coefficients(ConstantSrgb(preset.absorption), ConstantSrgb(preset.reducedScattering));
    }
    if (!p.sigmaA != !p.sigmaS)
        throw set.Error(p.sigmaA ? "sigma_a" : "sigma_s", "\"sigma_a\" and \"sigma_s\" must be given together.");
    if (p.sigmaA) {
        SpectrumInput sigmaA = in(p.sigmaA);
        return SubsurfaceMatter::Coefficients(std::move(sigmaA), in(p.sigmaS));
    }
    if (p.reflectance) {
        SpectrumInput reflectance = in(p.reflectance);
        return SubsurfaceMatter::Reflectance(std::move(reflectance), in(p.mfp));
    }
    return SubsurfaceMatter::Coefficients(ConstantSrgb({Float(.0011), Float(.0024), Float(.014)}),
                                          ConstantSrgb({Float(2.55), Float(3.21), Float(3.77)}));
}

std::shared_ptr<SurfaceMaterial> MakeSubsurface(const SubsurfaceParams &p, const ParamSet &set,
                                                MaterialContext &context) {
    SubsurfaceMatter matter = MakeSubsurfaceMatter(p, set, context);
    Float g = p.g;
    if (g != 0 && !p.name.empty()) {
        set.Warn(context.sink, "g", "\"g\" has no effect beside \"name\".");
        g = 0;
    }
    CheckIndex(set, "eta", ConstantSpectrum(p.eta));
    return std::make_shared<SubsurfaceMaterial>(std::move(matter), p.scale, p.roughness.Make(context, p.remap),
                                                SubsurfaceTable::Shared(g, p.eta));
}

struct MixParams {
    std::span<const std::string> materials;
    FloatTextureParam amount{Float(0.5)};
    template <class V>
    void Describe(V &&v) {
        v("materials", materials, "two names of materials");
        v("amount", amount, "probability of the second material at a point");
    }
};

uint64_t HashText(const std::string &text) {
    uint64_t h = Hash(uint64_t(text.size()));
    for (char c : text) h = Hash(h, c);
    return h;
}

MaterialPtr MakeMix(const MixParams &p, const ParamSet &set, MaterialContext &context) {
    const std::span<const std::string> names = p.materials;
    if (names.size() != 2)
        throw set.Error("materials",
                        fmt::format("\"string materials\" takes two names of materials, found {}.", names.size()));
    std::array<MaterialPtr, 2> materials;
    for (size_t i = 0; i < 2; ++i) {
        materials[i] = set.At("materials", [&] { return context.named(names[i]); });
        if (!materials[i])
            throw set.Error("materials", fmt::format("there is no material \"{}\" here.", Abbreviate(names[i])));
        if (materials[i]->IsInterface())
            throw set.Error("materials", fmt::format("\"{}\" is an interface, which cannot be mixed.", names[i]));
    }
    const FloatInput amount = Inputs(context)(p.amount);
    const bool needsFootprint =
        context.usesFootprint || materials[0]->NeedsFootprint() || materials[1]->NeedsFootprint();
    auto mix =
        std::make_shared<MixMaterial>(std::move(materials), amount, Hash(HashText(names[0]), HashText(names[1])));
    mix->SetNeedsFootprint(needsFootprint);
    if (mix->Depth() > kMaxNesting)
        throw set.Error("materials", fmt::format("mixes are nested more than {} deep here.", kMaxNesting));
    return mix;
}

/// Adds a surface material: `make` creates it, then its normal or bump map is set.
template <class P, class F>
void AddSurface(MaterialTable &table, const char *name, const char *summary, F make) {
    table.Add<P>(name, summary, [make](const P &p, const ParamSet &set, MaterialContext &context) {
        context.usesFootprint = false;
        auto material = make(p, set, context);
        if constexpr (std::is_base_of_v<ReliefParams, P>) {
            if (!p.normalMap.empty())
                material->SetNormalMap(std::make_unique<NormalMap>(
                    set.At("normalmap", [&] { return context.textures.GetLinearRgbImage(p.normalMap); })));
            if (p.displacement) {
                material->SetBumpMap(BumpMap(context.textures.Get(p.displacement)));
                context.usesFootprint = true;  // the bump map's step is half the footprint
            }
        }
        material->SetNeedsFootprint(context.usesFootprint);
        return material;
    });
}

}  // namespace

const MaterialTable &Materials() {
    static const MaterialTable table = [] {
        using Context = MaterialContext;
        MaterialTable t("Material");
        AddSurface<DiffuseParams>(t, "diffuse", "", [](const auto &p, const ParamSet &, Context &c) {
            return std::make_shared<DiffuseMaterial>(Inputs(c)(p.reflectance));
        });
        AddSurface<CoatedDiffuseParams>(t, "coateddiffuse", "", [](const auto &p, const ParamSet &set, Context &c) {
            return std::make_shared<CoatedDiffuseMaterial>(p.Coat(set, c), Inputs(c)(p.reflectance));
        });
        AddSurface<CoatedConductorParams>(t, "coatedconductor", "", [](const auto &p, const ParamSet &set, Context &c) {
            return std::make_shared<CoatedConductorMaterial>(p.Coat(set, c), p.metal.Make(set, c),
                                                             p.metalRoughness.Make(c, p.remap));
        });
        AddSurface<ConductorParams>(t, "conductor", "", [](const auto &p, const ParamSet &set, Context &c) {
            return std::make_shared<ConductorMaterial>(p.metal.Make(set, c), p.roughness.Make(c, p.remap));
        });
        AddSurface<DielectricParams>(
            t, "dielectric", "**differs**: an index that is not above 0 is an error, in all materials",
            [](const auto &p, const ParamSet &set, Context &c) {
                return std::make_shared<DielectricMaterial>(p.index.Make(set, c), p.roughness.Make(c, p.remap));
            });
        AddSurface<ThinDielectricParams>(t, "thindielectric", "", [](const auto &p, const ParamSet &set, Context &c) {
            return std::make_shared<ThinDielectricMaterial>(p.index.Make(set, c));
        });
        AddSurface<DiffuseTransmissionParams>(
            t, "diffusetransmission", "", [](const auto &p, const ParamSet &, Context &c) {
                Inputs in(c);
                return std::make_shared<DiffuseTransmissionMaterial>(in(p.reflectance), in(p.transmittance), p.scale);
            });
        AddSurface<HairParams>(t, "hair", "", [](const auto &p, const ParamSet &set, Context &c) {
            Inputs in(c);
            FloatTexturePtr eta = in.Note(c.textures.Get(p.eta));
            if (auto constant = eta->Constant()) CheckIndex(set, "eta", ConstantSpectrum(*constant));
            return std::make_shared<HairMaterial>(MakeHairColor(p, set, c), FloatInput(std::move(eta)), in(p.betaM),
                                                  in(p.betaN), in(p.alpha));
        });
        AddSurface<MeasuredParams>(
            t, "measured",
            "isotropic, or anisotropic over the whole circle; else **not supported**: `field \"phi_i\" covers a part "
            "of "
            "the circle only; such reduced tables are not supported.` The databases cannot be shipped, so tests write "
            "their own files",
            [](const auto &p, const ParamSet &set, Context &c) {
                return std::make_shared<MeasuredMaterial>(
                    set.At("filename", [&] { return ReadMeasuredBrdf(c.files.Resolve(p.filename)); }));
            });
        AddSurface<SubsurfaceParams>(
            t, "subsurface",
            "scatters light below the surface with volpath only, as in stock; **differs** a little, see below",
            MakeSubsurface);
        t.Add<NoParams>(
            "interface", "also \"\" and \"none\", with a warning",
            [](const auto &, const ParamSet &, Context &) { return std::make_shared<InterfaceMaterial>(); });
        t.Add<MixParams>("mix", "", [](const auto &p, const ParamSet &set, Context &c) {
            c.usesFootprint = false;
            return MakeMix(p, set, c);
        });
        return t;
    }();
    return table;
}

MaterialPtr MakeMaterial(const std::string &type, const ParamSet &params, MaterialContext &context) {
    if (!type.empty() && type != "none") return Materials().Make(type, params, context);
    context.sink.Warning(params.Loc(), fmt::format("material \"{}\" is deprecated; write \"interface\".", type));
    return Materials().Make("interface", params, context);
}

}  // namespace pbrt
