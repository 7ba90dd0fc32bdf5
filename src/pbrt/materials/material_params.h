#pragma once
#include "pbrt/materials/material_factory.h"
#include "pbrt/materials/material_inputs.h"
#include "pbrt/materials/surface_material.h"

// Parameters that several materials share, and how materials are added to the table.

namespace pbrt {

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

inline SpectrumTextureParam Albedo(std::optional<Float> value = {}) { return {{SpectrumUse::Albedo, value}}; }
inline SpectrumTextureParam Unbounded(std::optional<Float> value = {}, const char *named = nullptr) {
    return {{SpectrumUse::Unbounded, value, named}};
}

/// Throws on an invalid index of refraction: a dielectric's must be positive, a metal's >= 0, and none above kMaxIndex,
/// whose square is finite. Tables may be 0, as beyond their ends, where stock uses 1.
void CheckIndex(const ParamSet &set, const std::string &name, const Spectrum &eta, bool isMetal = false);

/// Spectrum of an sRGB colour without an upper bound, the same everywhere.
SpectrumInput ConstantSrgb(const Rgb &rgb);

struct RoughnessParams {
    std::string prefix{};
    FloatTextureParam both{0}, u{}, v{};
    void Describe(auto &&visit) {
        constexpr Range<Float> kRange{0, 1e6f};
        visit(prefix + "uroughness", u, kRange, "roughness along u");
        visit(prefix + "vroughness", v, kRange, "roughness along v");
        if (visit.When(!u || !v)) visit(prefix + "roughness", both, kRange, "roughness where none is given");
    }
    RoughnessInput Make(MaterialContext &context, bool remap) const {
        Inputs in(context);
        return {in(u ? u : both), in(v ? v : both), remap};
    }
};

struct RemapParams {
    bool remap = true;
    void Describe(auto &&v) { v("remaproughness", remap, "alpha is the roughness' square root; false: the roughness"); }
};

struct ReliefParams {
    std::string normalMap;
    FloatTextureParam displacement{};
    void Describe(auto &&v) {
        v("displacement", displacement, "bump map heights, in world units");
        v("normalmap", normalMap, "image of normals; overrides displacement");
    }
};

/// Adds a surface material: `make` creates it, then its normal or bump map is set.
template <class P, class F>
void AddSurface(MaterialTable &table, const char *name, const char *summary, F make) {
    table.Add<P>(name, summary, [make](const P &p, const ParamSet &set, MaterialContext &context) {
        context.usesFootprint = false;
        auto material = make(p, set, context);
        if constexpr (std::is_base_of_v<ReliefParams, P>) {
            if (!p.normalMap.empty())
                material->SetNormalMap(
                    set.At("normalmap", [&] { return context.textures.GetLinearRgbImage(p.normalMap); }));
            if (p.displacement) {
                material->SetBumpMap(context.textures.Get(p.displacement));
                context.usesFootprint = true;  // the bump map's step is half the footprint
            }
        }
        material->SetNeedsFootprint(context.usesFootprint);
        return material;
    });
}

void AddHair(MaterialTable &table);
void AddMeasured(MaterialTable &table);
void AddMix(MaterialTable &table);
void AddSubsurface(MaterialTable &table);

/// Reads a BRDF of the RGL material database (isotropic, or anisotropic over the whole circle). Throws UserError (no
/// location).
std::shared_ptr<const MeasuredBrdf> ReadMeasuredBrdf(const std::string &path);

}  // namespace pbrt
