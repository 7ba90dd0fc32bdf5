#include "pbrt/materials/material_factory.h"

#include <algorithm>

#include "pbrt/core/limits.h"
#include "pbrt/materials/coated_materials.h"
#include "pbrt/materials/conductor_material.h"
#include "pbrt/materials/dielectric_materials.h"
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

/// Everything a maker may ask.
struct Request {
    const ParamSet &params;
    TextureLibrary &textures;
    const FileResolver &files;
    DiagnosticSink &sink;
    const std::function<MaterialPtr(const std::string &)> &named;

    SpectrumInput Albedo(const std::string &name, Float defaultValue) const {
        return SpectrumInput(
            textures.GetSpectrum(params, name, std::make_shared<ConstantSpectrum>(defaultValue), SpectrumUse::Albedo));
    }
    FloatInput Number(const std::string &name, Float defaultValue) const {
        return FloatInput(textures.GetFloat(params, name, defaultValue));
    }
    /// A dielectric's index of refraction is positive; none is above kMaxIndex, whose square is finite. Tables are 0
    /// beyond their ends, where stock takes 1.
    void CheckIndex(const std::string &name, const Spectrum &eta, bool isMetal = false) const {
        Float low = Infinity, high = -Infinity;
        for (Float nm = LambdaMin; nm <= LambdaMax; ++nm) {
            low = std::min(low, eta(nm));
            high = std::max(high, eta(nm));
        }
        const bool isTable = !dynamic_cast<const ConstantSpectrum *>(&eta);
        constexpr Float kMaxIndex = 1e6f;
        if (high > kMaxIndex)
            throw UserError(
                fmt::format("{}: \"{}\" is {}; it must be at most {}.", params.What(), name, high, kMaxIndex),
                params.LocOf(name));
        if (low >= 0 && (isMetal || isTable || high > 0)) return;
        throw UserError(fmt::format("{}: \"{}\" {} {}; it must {}.", params.What(), name,
                                    low == high ? "is" : "goes down to", low,
                                    isMetal ? "not be negative" : "be positive"),
                        params.LocOf(name));
    }
    void CheckIndex(const std::string &name, Float eta) const { CheckIndex(name, ConstantSpectrum(eta)); }
    IndexInput Index(const std::string &name) const {
        SpectrumPtr eta = GetSpectrumOrFloat(params, name, std::make_shared<ConstantSpectrum>(Float(1.5)),
                                             SpectrumUse::Unbounded, files);
        CheckIndex(name, *eta);
        return IndexInput(std::move(eta));
    }
    RoughnessInput Roughness(const std::string &prefix, bool remap) const {
        return RoughnessInput(params, textures, prefix, remap);
    }
    bool RemapRoughness() const { return params.GetBool("remaproughness", true); }

    /// `reflectance`, or `eta` and `k` (with a prefix), which are copper's by default.
    MetalInput Metal(const std::string &prefix) const {
        SpectrumTexturePtr eta = textures.GetSpectrumOrNull(params, prefix + "eta", SpectrumUse::Unbounded);
        SpectrumTexturePtr k = textures.GetSpectrumOrNull(params, prefix + "k", SpectrumUse::Unbounded);
        SpectrumTexturePtr reflectance = textures.GetSpectrumOrNull(params, "reflectance", SpectrumUse::Albedo);
        if (reflectance && (eta || k))
            throw UserError(fmt::format("{}: \"reflectance\" and \"{}{}\" cannot both be given.", params.What(), prefix,
                                        eta ? "eta" : "k"),
                            params.LocOf("reflectance"));
        if (reflectance) return MetalInput(SpectrumInput(reflectance));
        auto orCopper = [&](const SpectrumTexturePtr &given, const std::string &name) {
            if (given && given->Constant()) CheckIndex(prefix + name, *given->Constant(), true);
            return SpectrumInput(given ? given
                                       : textures.GetSpectrum(params, prefix + name, NamedSpectrum("metal-Cu-" + name),
                                                              SpectrumUse::Unbounded));
        };
        return MetalInput(orCopper(eta, "eta"), orCopper(k, "k"));
    }

    /// `prefix` applies to the coat's roughness and index only.
    CoatInput Coat(const std::string &prefix, bool remap) const {
        return {Roughness(prefix, remap),
                Index(prefix + "eta"),
                Number("thickness", Float(0.01)),
                Albedo("albedo", 0),
                Number("g", 0),
                params.GetInt("maxdepth", 10, {0, 1 << 16}),
                params.GetInt("nsamples", 1, {1, 1 << 16})};
    }
};

using SurfacePtr = std::shared_ptr<SurfaceMaterial>;

SurfacePtr MakeDiffuse(const Request &r) {
    return std::make_shared<DiffuseMaterial>(r.Albedo("reflectance", Float(0.5)));
}

SurfacePtr MakeDiffuseTransmission(const Request &r) {
    return std::make_shared<DiffuseTransmissionMaterial>(r.Albedo("reflectance", Float(0.25)),
                                                         r.Albedo("transmittance", Float(0.25)),
                                                         r.params.GetFloat("scale", 1));
}

SurfacePtr MakeConductor(const Request &r) {
    return std::make_shared<ConductorMaterial>(r.Metal(""), r.Roughness("", r.RemapRoughness()));
}

SurfacePtr MakeDielectric(const Request &r) {
    return std::make_shared<DielectricMaterial>(r.Index("eta"), r.Roughness("", r.RemapRoughness()));
}

SurfacePtr MakeThinDielectric(const Request &r) { return std::make_shared<ThinDielectricMaterial>(r.Index("eta")); }

SurfacePtr MakeCoatedDiffuse(const Request &r) {
    return std::make_shared<CoatedDiffuseMaterial>(r.Coat("", r.RemapRoughness()), r.Albedo("reflectance", Float(0.5)));
}

SurfacePtr MakeCoatedConductor(const Request &r) {
    bool remap = r.RemapRoughness();
    return std::make_shared<CoatedConductorMaterial>(r.Coat("interface.", remap), r.Metal("conductor."),
                                                     r.Roughness("conductor.", remap));
}

/// The first of the ways to say it that is there; the others have no effect.
HairColor ReadHairColor(const Request &r) {
    SpectrumTexturePtr sigmaA = r.textures.GetSpectrumOrNull(r.params, "sigma_a", SpectrumUse::Unbounded);
    const char *reflectanceName = "reflectance";
    SpectrumTexturePtr reflectance = r.textures.GetSpectrumOrNull(r.params, reflectanceName, SpectrumUse::Albedo);
    if (!reflectance)
        reflectance = r.textures.GetSpectrumOrNull(r.params, reflectanceName = "color", SpectrumUse::Albedo);
    FloatTexturePtr eumelanin = r.textures.GetFloatOrNull(r.params, "eumelanin");
    FloatTexturePtr pheomelanin = r.textures.GetFloatOrNull(r.params, "pheomelanin");
    const char *used = sigmaA ? "sigma_a" : reflectance ? reflectanceName : nullptr;
    auto ignore = [&](bool given, const char *name) {
        if (used && given)
            r.sink.Warning(r.params.LocOf(name),
                           fmt::format("{}: \"{}\" has no effect beside \"{}\".", r.params.What(), name, used));
    };
    if (sigmaA) ignore(reflectance != nullptr, reflectanceName);
    ignore(eumelanin != nullptr, "eumelanin");
    ignore(pheomelanin != nullptr, "pheomelanin");

    if (sigmaA) return HairColor::Absorption(SpectrumInput(sigmaA));
    if (reflectance) return HairColor::Reflectance(SpectrumInput(reflectance));
    const bool none = !eumelanin && !pheomelanin;
    return HairColor::Pigments(eumelanin ? FloatInput(eumelanin) : FloatInput(none ? Float(1.3) : Float(0)),
                               pheomelanin ? FloatInput(pheomelanin) : FloatInput(Float(0)));
}

SurfacePtr MakeHair(const Request &r) {
    FloatTexturePtr eta = r.textures.GetFloat(r.params, "eta", Float(1.55));
    if (auto constant = eta->Constant()) r.CheckIndex("eta", *constant);
    return std::make_shared<HairMaterial>(ReadHairColor(r), FloatInput(std::move(eta)), r.Number("beta_m", Float(0.3)),
                                          r.Number("beta_n", Float(0.3)), r.Number("alpha", 2));
}

SurfacePtr MakeMeasured(const Request &r) {
    const std::string file = r.params.GetString("filename", "");
    if (file.empty())
        throw UserError(fmt::format("{}: \"string filename\" is required.", r.params.What()), r.params.Loc());
    try {
        return std::make_shared<MeasuredMaterial>(ReadMeasuredBrdf(r.files.Resolve(file)));
    } catch (const UserError &e) {
        throw UserError(e.Diagnostics().front().message, r.params.LocOf("filename"));
    }
}

SpectrumInput ConstantSrgb(const std::array<Float, 3> &rgb) {
    return SpectrumInput(std::make_shared<ConstantSpectrumTexture>(
        std::make_shared<RgbUnboundedSpectrum>(ColorSpace::SRGB(), Rgb(rgb[0], rgb[1], rgb[2]))));
}

const ScatteringPreset &FindPreset(const Request &r, const std::string &name) {
    std::vector<std::string> names;
    for (const ScatteringPreset &preset : EmbeddedScatteringPresets()) {
        if (preset.name == name) return preset;
        names.push_back(preset.name);
    }
    throw UserError(fmt::format("{}: there is no medium \"{}\"; {}.", r.params.What(), name, ListChoices(name, names)),
                    r.params.LocOf("name"));
}

/// By name, by coefficients, by what is seen from outside, or what stock takes if nothing is said.
SubsurfaceMatter ReadSubsurfaceMatter(const Request &r) {
    const std::string name = r.params.GetString("name", "");
    if (!name.empty()) {
        const ScatteringPreset &preset = FindPreset(r, name);
        return SubsurfaceMatter::Coefficients(ConstantSrgb(preset.absorption), ConstantSrgb(preset.reducedScattering));
    }
    SpectrumTexturePtr sigmaA = r.textures.GetSpectrumOrNull(r.params, "sigma_a", SpectrumUse::Unbounded);
    SpectrumTexturePtr sigmaS = r.textures.GetSpectrumOrNull(r.params, "sigma_s", SpectrumUse::Unbounded);
    if (!sigmaA != !sigmaS)
        throw UserError(fmt::format("{}: \"sigma_a\" and \"sigma_s\" must be given together.", r.params.What()),
                        r.params.LocOf(sigmaA ? "sigma_a" : "sigma_s"));
    if (sigmaA) return SubsurfaceMatter::Coefficients(SpectrumInput(sigmaA), SpectrumInput(sigmaS));
    if (SpectrumTexturePtr reflectance = r.textures.GetSpectrumOrNull(r.params, "reflectance", SpectrumUse::Albedo))
        return SubsurfaceMatter::Reflectance(
            SpectrumInput(reflectance),
            SpectrumInput(r.textures.GetSpectrum(r.params, "mfp", std::make_shared<ConstantSpectrum>(Float(1)),
                                                 SpectrumUse::Unbounded)));
    return SubsurfaceMatter::Coefficients(ConstantSrgb({Float(.0011), Float(.0024), Float(.014)}),
                                          ConstantSrgb({Float(2.55), Float(3.21), Float(3.77)}));
}

SurfacePtr MakeSubsurface(const Request &r) {
    SubsurfaceMatter matter = ReadSubsurfaceMatter(r);
    Float g = r.params.GetFloat("g", 0, {-1, 1, true, true});
    if (g != 0 && !r.params.GetString("name", "").empty()) {
        r.sink.Warning(r.params.LocOf("g"), fmt::format("{}: \"g\" has no effect beside \"name\".", r.params.What()));
        g = 0;
    }
    const Float eta = r.params.GetFloat("eta", Float(1.33));
    r.CheckIndex("eta", eta);
    return std::make_shared<SubsurfaceMaterial>(std::move(matter), r.params.GetFloat("scale", 1),
                                                r.Roughness("", r.RemapRoughness()), SubsurfaceTable::Shared(g, eta));
}

uint64_t HashText(const std::string &text) {
    uint64_t h = Hash(uint64_t(text.size()));
    for (char c : text) h = Hash(h, c);
    return h;
}

MaterialPtr MakeMix(const Request &r) {
    std::span<const std::string> names = r.params.GetStrings("materials");
    FileLoc loc = r.params.LocOf("materials");
    if (names.size() != 2)
        throw UserError(fmt::format("{}: \"string materials\" takes two names of materials, found {}.", r.params.What(),
                                    names.size()),
                        loc);
    std::array<MaterialPtr, 2> materials;
    for (size_t i = 0; i < 2; ++i) {
        try {
            materials[i] = r.named(names[i]);
        } catch (const UserError &e) {
            if (e.Diagnostics().front().loc) throw;
            throw UserError(e.Diagnostics().front().message, loc);
        }
        if (!materials[i])
            throw UserError(fmt::format("{}: there is no material \"{}\" here.", r.params.What(), Abbreviate(names[i])),
                            loc);
        if (materials[i]->IsInterface())
            throw UserError(
                fmt::format("{}: \"{}\" is an interface, which cannot be mixed.", r.params.What(), names[i]), loc);
    }
    const size_t footprintUses = r.textures.FootprintUses();
    const FloatInput amount = r.Number("amount", Float(0.5));
    const bool needsFootprint = r.textures.FootprintUses() > footprintUses || materials[0]->NeedsFootprint() ||
                                materials[1]->NeedsFootprint();
    auto mix = std::make_shared<MixMaterial>(std::move(materials), amount, Hash(HashText(names[0]), HashText(names[1])));
    mix->SetNeedsFootprint(needsFootprint);
    if (mix->Depth() > kMaxNesting)
        throw UserError(fmt::format("{}: mixes are nested more than {} deep here.", r.params.What(), kMaxNesting), loc);
    return mix;
}

struct SurfaceType {
    const char *name;
    SurfacePtr (*make)(const Request &);
    bool hasRelief = true;  ///< takes normal maps and displacement
};
constexpr SurfaceType kSurfaceTypes[] = {
    {"diffuse", MakeDiffuse},
    {"coateddiffuse", MakeCoatedDiffuse},
    {"coatedconductor", MakeCoatedConductor},
    {"conductor", MakeConductor},
    {"dielectric", MakeDielectric},
    {"thindielectric", MakeThinDielectric},
    {"diffusetransmission", MakeDiffuseTransmission},
    {"hair", MakeHair, false},
    {"measured", MakeMeasured},
    {"subsurface", MakeSubsurface},
};

}  // namespace

const std::vector<std::string> &SupportedMaterials() {
    static const std::vector<std::string> kNames = [] {
        std::vector<std::string> names = {"interface", "mix"};
        for (const SurfaceType &type : kSurfaceTypes) names.push_back(type.name);
        std::sort(names.begin(), names.end());
        return names;
    }();
    return kNames;
}

MaterialPtr MakeMaterial(const std::string &type, const ParamSet &params, TextureLibrary &textures,
                         const FileResolver &files, DiagnosticSink &sink,
                         const std::function<MaterialPtr(const std::string &)> &named) {
    Request request{params, textures, files, sink, named};
    const size_t footprintUses = textures.FootprintUses();
    for (const SurfaceType &known : kSurfaceTypes) {
        if (type != known.name) continue;
        SurfacePtr material = known.make(request);
        bool hasBumps = false;
        if (known.hasRelief) {
            if (auto image = textures.GetLinearRgbImage(params, "normalmap"))
                material->SetNormalMap(std::make_unique<NormalMap>(std::move(image)));
            if (FloatTexturePtr height = textures.GetFloatOrNull(params, "displacement")) {
                material->SetBumpMap(BumpMap(std::move(height)));
                hasBumps = true;  // steps by half the footprint
            }
        }
        material->SetNeedsFootprint(hasBumps || textures.FootprintUses() > footprintUses);
        params.ReportUnused(sink);
        return material;
    }
    if (type == "interface" || type.empty() || type == "none") {
        if (type != "interface")
            sink.Warning(params.Loc(), fmt::format("material \"{}\" is deprecated; write \"interface\".", type));
        params.ReportUnused(sink);
        return std::make_shared<InterfaceMaterial>();
    }
    if (type == "mix") {
        MaterialPtr material = MakeMix(request);
        params.ReportUnused(sink);
        return material;
    }
    throw UserError(fmt::format("there is no material \"{}\"; {}.", type, ListChoices(type, SupportedMaterials())),
                    params.Loc());
}

}  // namespace pbrt
