#include <algorithm>

#include "pbrt/materials/material_params.h"

#include "pbrt/math/frame.h"
#include "pbrt/textures/texture.h"

namespace pbrt {
namespace {

/// Finite difference step in u or v where the footprint is unknown.
constexpr Float kDefaultStep = 5e-4f;

Float Step(Float perPixelX, Float perPixelY) {
    Float half = (std::abs(perPixelX) + std::abs(perPixelY)) / 2;
    return half > 0 ? half : kDefaultStep;
}

class ForcedDiffuseMaterial final : public Material {
  public:
    explicit ForcedDiffuseMaterial(MaterialPtr original) : original_(std::move(original)) {
        SetNeedsFootprint(original_->NeedsFootprint());
    }

    Bsdf GetBsdf(const SurfacePoint &point, SampledWavelengths &lambda) const override {
        const Bsdf bsdf = original_->GetBsdf(point, lambda);
        if (!bsdf) return bsdf;
        const SampledSpectrum albedo = Clamp(EstimateAlbedo(bsdf, point.wo), 0, 1);
        return Bsdf(point.shading.n, point.shading.dpdu, DiffuseBxdf(albedo));
    }
    void PerturbShading(SurfacePoint &point) const override { original_->PerturbShading(point); }

  private:
    MaterialPtr original_;
};

struct IndexParams {
    SpectrumParam eta{SpectrumUse::Unbounded, Float(1.5), nullptr, true};
    std::string name = "eta";
    void Describe(auto &&v) { v(name, eta, "index of refraction"); }
    IndexInput Make(const ParamSet &set, const MaterialContext &context) const {
        SpectrumPtr spectrum = eta.Make(context.files);
        CheckIndex(set, name, *spectrum);
        return IndexInput(std::move(spectrum));
    }
};

struct MetalParams {
    std::string prefix{};
    SpectrumTextureParam eta = Unbounded({}, "metal-Cu-eta"), k = Unbounded({}, "metal-Cu-k"), reflectance = Albedo();
    void Describe(auto &&v) {
        v(prefix + "eta", eta, "index of refraction");
        v(prefix + "k", k, "imaginary part of the index");
        v("reflectance", reflectance, "reflectance at normal incidence, instead of eta and k");
    }
    MetalInput Make(const ParamSet &set, MaterialContext &context) const {
        Inputs in(context);
        if (reflectance && (eta || k))
            throw set.Error("reflectance", "\"reflectance\" and \"{}{}\" cannot both be given.", prefix,
                            eta ? "eta" : "k");
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

struct DiffuseParams : ReliefParams {
    SpectrumTextureParam reflectance = Albedo(Float(0.5));
    void Describe(auto &&v) {
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
    void Describe(auto &&v) {
        roughness.Describe(v);
        index.Describe(v);
        v("thickness", thickness, "optical thickness along the normal");
        v("albedo", albedo, "albedo of the coat's medium; 0: only absorbs");
        v("g", g, "scattering asymmetry of the coat's medium");
        v("maxdepth", maxDepth, Range<int>{0, 1 << 16}, "maximum scattering events in the coat");
        v("nsamples", samples, Range<int>{1, 1 << 16}, "random walks per evaluation");
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
    void Describe(auto &&v) {
        v("reflectance", reflectance, "albedo below the coat");
        CoatParams::Describe(v);
    }
};

struct CoatedConductorParams : CoatParams {
    MetalParams metal{"conductor."};
    RoughnessParams metalRoughness{"conductor."};
    CoatedConductorParams() : CoatParams("interface.") {}
    void Describe(auto &&v) {
        metal.Describe(v);
        metalRoughness.Describe(v);
        CoatParams::Describe(v);
    }
};

/// The parameters of several structs, in this order.
template <class... Parts>
struct JoinedParams : Parts... {
    void Describe(auto &&v) { (Parts::Describe(v), ...); }
};
using ConductorParams = JoinedParams<MetalParams, RoughnessParams, RemapParams, ReliefParams>;
using DielectricParams = JoinedParams<IndexParams, RoughnessParams, RemapParams, ReliefParams>;
using ThinDielectricParams = JoinedParams<IndexParams, ReliefParams>;

struct DiffuseTransmissionParams : ReliefParams {
    SpectrumTextureParam reflectance = Albedo(Float(0.25)), transmittance = Albedo(Float(0.25));
    Float scale = 1;
    void Describe(auto &&v) {
        v("reflectance", reflectance, "fraction of light reflected");
        v("transmittance", transmittance, "fraction of light transmitted");
        v("scale", scale, "factor of reflectance and transmittance");
        ReliefParams::Describe(v);
    }
};

std::shared_ptr<SurfaceMaterial> MakeCoatedDiffuse(const CoatedDiffuseParams &p, const ParamSet &set,
                                                   MaterialContext &context) {
    const CoatInput coat = p.Coat(set, context);
    // In place of random walks; null if it does not cover the coat.
    const std::shared_ptr<const CoatTable> table = coat.Table();
    const SpectrumInput reflectance = Inputs(context)(p.reflectance);
    return MakeLobeMaterial([=](const SurfacePoint &point, SampledWavelengths &lambda) {
        const DiffuseBxdf base(Clamp(reflectance(point, lambda), 0, 1));
        CoatedDiffuseBxdf lobe = coat.Over(base, coat.eta(lambda), point, lambda);
        if (table) lobe.UseTable(*table);
        return lobe;
    });
}

std::shared_ptr<SurfaceMaterial> MakeCoatedConductor(const CoatedConductorParams &p, const ParamSet &set,
                                                     MaterialContext &context) {
    const CoatInput coat = p.Coat(set, context);
    const MetalInput metal = p.metal.Make(set, context);
    const RoughnessInput roughness = p.metalRoughness.Make(context, p.remap);
    return MakeLobeMaterial([=](const SurfacePoint &point, SampledWavelengths &lambda) {
        // Under the coat, the metal's index is relative to the coat's.
        const MetalInput::Index index = metal(point, lambda);
        const Float coatEta = coat.eta(lambda);
        const ConductorBxdf base(roughness(point), index.eta / coatEta, index.k / coatEta);
        return coat.Over(base, coatEta, point, lambda);
    });
}

class InterfaceMaterial final : public Material {
  public:
    Bsdf GetBsdf(const SurfacePoint &, SampledWavelengths &) const override { return {}; }
    const Material *Resolve(const SurfacePoint &) const override { return nullptr; }
    bool IsInterface() const override { return true; }
};

}  // namespace

void ApplyBumpMap(const FloatTexture &height, SurfacePoint &point) {
    SurfacePoint::Shading &shading = point.shading;
    const TextureContext here(point);
    const Float elevation = height.Evaluate(here);
    // Tangents of the displaced surface p + height n: dp/du + (dheight/du) n + height dn/du, likewise for v.
    auto tangent = [&](const Vector3 &dpds, const Normal3 &dnds, const Point2 &uvStep, Float step) {
        TextureContext beside = here;
        beside.p += dpds * step;
        beside.uv += uvStep;
        return dpds + shading.n * ((height.Evaluate(beside) - elevation) / step) + dnds * elevation;
    };
    const Float du = Step(point.dudx, point.dudy), dv = Step(point.dvdx, point.dvdy);
    const Vector3 dpdu = tangent(shading.dpdu, shading.dndu, {du, 0}, du);
    const Vector3 dpdv = tangent(shading.dpdv, shading.dndv, {0, dv}, dv);
    const Float size = Dot(Abs(Cross(dpdu, dpdv)), Vector3(1));
    if (!(size > 0 && size < Infinity)) return;
    shading.dpdu = dpdu;
    shading.dpdv = dpdv;
    shading.n = FaceForward(RobustUnitCross(dpdu, dpdv), point.n);
}

void ApplyNormalMap(const Image &image, SurfacePoint &point) {
    Point2 st(point.uv.x, 1 - point.uv.y);
    Vector3 mapped;
    for (int c = 0; c < 3; ++c) mapped[c] = 2 * image.Bilinear(st, c, WrapMode::Repeat) - 1;
    if (!(LengthSquared(mapped) > 0)) return;

    SurfacePoint::Shading &shading = point.shading;
    Vector3 ns = Normalize(Frame::FromXZ(shading.dpdu, shading.n).FromLocal(Normalize(mapped)));
    Vector3 along = shading.dpdu - ns * Dot(ns, shading.dpdu);
    if (!(LengthSquared(along) > 0)) return;
    along = Normalize(along);
    shading.dpdu = along * Length(shading.dpdu);
    shading.dpdv = Cross(ns, along) * Length(shading.dpdv);
    shading.n = FaceForward(ns, point.n);
}

void CheckIndex(const ParamSet &set, const std::string &name, const Spectrum &eta, bool isMetal) {
    Float low = Infinity, high = -Infinity;
    for (Float nm = LambdaMin; nm <= LambdaMax; ++nm) {
        low = std::min(low, eta(nm));
        high = std::max(high, eta(nm));
    }
    const bool isTable = !eta.IsConstant();
    constexpr Float kMaxIndex = 1e6f;
    if (high > kMaxIndex) throw set.Error(name, "\"{}\" is {}; it must be at most {}.", name, high, kMaxIndex);
    if (low >= 0 && (isMetal || isTable || high > 0)) return;
    throw set.Error(name, "\"{}\" {} {}; it must {}.", name, low == high ? "is" : "goes down to", low,
                    isMetal ? "not be negative" : "be positive");
}

SpectrumInput ConstantSrgb(const Rgb &rgb) {
    return SpectrumInput(
        std::make_shared<ConstantSpectrumTexture>(std::make_shared<RgbUnboundedSpectrum>(ColorSpace::SRGB(), rgb)));
}

const MaterialTable &Materials() {
    static const MaterialTable table("Material", [](MaterialTable &t) {
        AddSurface<DiffuseParams>(t, "diffuse", "", [](const auto &p, const ParamSet &, auto &c) {
            return MakeLobeMaterial([reflectance = Inputs(c)(p.reflectance)](const SurfacePoint &point, auto &lambda) {
                return DiffuseBxdf(Clamp(reflectance(point, lambda), 0, 1));
            });
        });
        AddSurface<CoatedDiffuseParams>(t, "coateddiffuse", "", MakeCoatedDiffuse);
        AddSurface<CoatedConductorParams>(t, "coatedconductor", "", MakeCoatedConductor);
        AddSurface<ConductorParams>(t, "conductor", "", [](const auto &p, const ParamSet &set, auto &c) {
            const MetalInput metal = p.MetalParams::Make(set, c);
            const RoughnessInput roughness = p.RoughnessParams::Make(c, p.remap);
            return MakeLobeMaterial([=](const SurfacePoint &point, const SampledWavelengths &lambda) {
                const MetalInput::Index index = metal(point, lambda);
                return ConductorBxdf(roughness(point), index.eta, index.k);
            });
        });
        AddSurface<DielectricParams>(
            t, "dielectric", "**differs**: an index that is not above 0 is an error, in all materials",
            [](const auto &p, const ParamSet &set, auto &c) {
                const IndexInput eta = p.IndexParams::Make(set, c);
                const RoughnessInput roughness = p.RoughnessParams::Make(c, p.remap);
                return MakeLobeMaterial([=](const SurfacePoint &point, SampledWavelengths &lambda) {
                    return DielectricBxdf(eta(lambda), roughness(point));
                });
            });
        AddSurface<ThinDielectricParams>(t, "thindielectric", "", [](const auto &p, const ParamSet &set, auto &c) {
            return MakeLobeMaterial([eta = p.IndexParams::Make(set, c)](const SurfacePoint &, auto &lambda) {
                return ThinDielectricBxdf(eta(lambda));
            });
        });
        AddSurface<DiffuseTransmissionParams>(
            t, "diffusetransmission", "", [](const auto &p, const ParamSet &, auto &c) {
                const SpectrumInput reflectance = Inputs(c)(p.reflectance), transmittance = Inputs(c)(p.transmittance);
                return MakeLobeMaterial(
                    [=, scale = p.scale](const SurfacePoint &point, const SampledWavelengths &lambda) {
                        return DiffuseTransmissionBxdf(Clamp(scale * reflectance(point, lambda), 0, 1),
                                                       Clamp(scale * transmittance(point, lambda), 0, 1));
                    });
            });
        AddHair(t);
        AddMeasured(t);
        AddSubsurface(t);
        t.Add<NoParams>("interface", "also \"\" and \"none\", with a warning",
                        [](const auto &, const ParamSet &, auto &) { return std::make_shared<InterfaceMaterial>(); });
        AddMix(t);
    });
    return table;
}

MaterialPtr MakeMaterial(const std::string &type, const ParamSet &params, MaterialContext &context) {
    if (!type.empty() && type != "none") return Materials().Make(type, params, context);
    context.sink.Warning(params.Loc(), "material \"{}\" is deprecated; write \"interface\".", type);
    return Materials().Make("interface", params, context);
}

MaterialPtr ForceDiffuse(MaterialPtr material) {
    if (material->IsInterface() || material->IsMix()) return material;
    return std::make_shared<ForcedDiffuseMaterial>(std::move(material));
}

}  // namespace pbrt
