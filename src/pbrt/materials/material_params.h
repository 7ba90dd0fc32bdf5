#pragma once
#include <memory>

#include "pbrt/bxdfs/layered.h"
#include "pbrt/images/image.h"
#include "pbrt/materials/material.h"
#include "pbrt/materials/material_factory.h"
#include "pbrt/spectra/color_space.h"
#include "pbrt/textures/texture.h"
#include "pbrt/textures/texture_factory.h"

// Inputs of materials, parameters that several materials share, and how materials are added to the table.

namespace pbrt {

/// Perturbs the shading frame as by a displacement along the shading normal (world units; Blinn 1978).
void ApplyBumpMap(const FloatTexture &height, SurfacePoint &point);

/// Rotates the shading frame to the normal of an image with channels R, G, B = (n + 1) / 2, x along dpdu and z along
/// the shading normal. Repeats; v = 0 is the bottom row. dpdu and dpdv stay orthogonal to the normal and keep their
/// lengths.
void ApplyNormalMap(const Image &image, SurfacePoint &point);

/// Base of all materials except mix and interface. May have a normal or bump map; of both, the normal map is used.
class SurfaceMaterial : public Material {
  public:
    SurfaceMaterial() { SetPlain(true); }
    void PerturbShading(SurfacePoint &point) const final {
        if (normalMap_) ApplyNormalMap(*normalMap_, point);
        else if (bumpMap_) ApplyBumpMap(*bumpMap_, point);
    }
    void SetNormalMap(std::shared_ptr<const Image> map) {
        normalMap_ = std::move(map);
        SetPlain(false);
    }
    void SetBumpMap(FloatTexturePtr height) {
        bumpMap_ = std::move(height);
        SetPlain(false);
    }

  private:
    std::shared_ptr<const Image> normalMap_;
    FloatTexturePtr bumpMap_;
};

/// Material whose lobe at a point is `lobe(point, lambda)`.
template <class F>
class LobeMaterial final : public SurfaceMaterial {
  public:
    explicit LobeMaterial(F lobe) : lobe_(std::move(lobe)) {}
    Bsdf GetBsdf(const SurfacePoint &point, SampledWavelengths &lambda) const override {
        return Bsdf(point.shading.n, point.shading.dpdu, lobe_(point, lambda));
    }

  private:
    F lobe_;
};

template <class F>
std::shared_ptr<SurfaceMaterial> MakeLobeMaterial(F lobe) {
    return std::make_shared<LobeMaterial<F>>(std::move(lobe));
}

class FloatInput {
  public:
    explicit FloatInput(FloatTexturePtr texture) : texture_(std::move(texture)) {
        if (auto constant = texture_->Constant()) {
            value_ = *constant;
            texture_.reset();
        }
    }
    explicit FloatInput(Float value) : value_(value) {}
    Float operator()(const SurfacePoint &point) const {
        return texture_ ? texture_->Evaluate(TextureContext(point)) : value_;
    }
    bool IsConstant() const { return !texture_; }
    std::optional<Float> Constant() const { return texture_ ? std::optional<Float>() : value_; }
    /// Conservative test that both are equal everywhere.
    bool SameAs(const FloatInput &o) const { return texture_ == o.texture_ && (texture_ || value_ == o.value_); }

  private:
    FloatTexturePtr texture_;  ///< null: value_ everywhere
    Float value_ = 0;
};

/// Spectrum parameter of a material. Constant spectra need no texture, uplifted reflectances no virtual call.
class SpectrumInput {
  public:
    explicit SpectrumInput(SpectrumTexturePtr texture)
        : texture_(std::move(texture)), constant_(texture_->Constant()),
          albedo_(dynamic_cast<const RgbAlbedoSpectrum *>(constant_)),
          isBlack_(constant_ && constant_->MaxValue() == 0) {}
    bool IsBlack() const { return isBlack_; }
    SampledSpectrum operator()(const SurfacePoint &point, const SampledWavelengths &lambda) const {
        if (albedo_) return albedo_->Sample(lambda);
        if (constant_) return constant_->Sample(lambda);
        return texture_->Evaluate(TextureContext(point), lambda);
    }

  private:
    SpectrumTexturePtr texture_;
    const Spectrum *constant_;         ///< owned by texture_
    const RgbAlbedoSpectrum *albedo_;  ///< constant_, if it is an uplifted reflectance; else null
    bool isBlack_;
};

class RoughnessInput {
  public:
    RoughnessInput(FloatInput u, FloatInput v, bool remap)
        : u_(std::move(u)), v_(std::move(v)), remap_(remap), sameInBoth_(u_.SameAs(v_)) {
        if (u_.IsConstant() && v_.IsConstant()) constant_ = Distribution(u_({}), v_({}));
    }
    TrowbridgeReitz operator()(const SurfacePoint &point) const {
        if (constant_) return *constant_;
        const Float u = u_(point);
        return Distribution(u, sameInBoth_ ? u : v_(point));
    }
    /// True if the roughness is certainly equal in both directions.
    bool IsIsotropic() const { return sameInBoth_; }
    const std::optional<TrowbridgeReitz> &Constant() const { return constant_; }

  private:
    TrowbridgeReitz Distribution(Float u, Float v) const {
        return remap_ ? TrowbridgeReitz(TrowbridgeReitz::RoughnessToAlpha(u), TrowbridgeReitz::RoughnessToAlpha(v))
                      : TrowbridgeReitz(u, v);
    }
    FloatInput u_, v_;
    bool remap_, sameInBoth_;
    std::optional<TrowbridgeReitz> constant_;
};

/// Index of refraction of a dielectric. If it depends on wavelength, secondary wavelengths are terminated.
class IndexInput {
  public:
    explicit IndexInput(SpectrumPtr eta) : eta_(std::move(eta)) {
        if (eta_->IsConstant()) constant_ = At(LambdaMin);
    }
    Float operator()(SampledWavelengths &lambda) const {
        if (constant_) return *constant_;
        lambda.TerminateSecondary();
        return At(lambda[0]);
    }
    const std::optional<Float> &Constant() const { return constant_; }

  private:
    /// 1 beyond the ends of a table.
    Float At(Float nm) const {
        const Float eta = (*eta_)(nm);
        return eta == 0 ? 1 : eta;
    }

    SpectrumPtr eta_;
    std::optional<Float> constant_;
};

/// Complex index of a metal, given directly or by reflectance.
class MetalInput {
  public:
    struct Index {
        SampledSpectrum eta, k;
    };
    MetalInput(SpectrumInput eta, SpectrumInput k) : first_(std::move(eta)), k_(std::move(k)) {}
    explicit MetalInput(SpectrumInput reflectance) : first_(std::move(reflectance)) {}

    /// For a reflectance r: eta 1 and the k whose normal-incidence Fresnel reflectance is r, clamped to 0.9999.
    Index operator()(const SurfacePoint &point, const SampledWavelengths &lambda) const {
        SampledSpectrum s = first_(point, lambda);
        if (k_) return {s, (*k_)(point, lambda)};
        return {SampledSpectrum(1), Clamp(s, 0, Float(0.9999)).Map([](Float r) { return 2 * std::sqrt(r / (1 - r)); })};
    }

  private:
    SpectrumInput first_;  ///< eta, or the reflectance if there is no k
    std::optional<SpectrumInput> k_;
};

struct CoatInput {
    RoughnessInput roughness;
    IndexInput eta;
    FloatInput thickness;
    SpectrumInput albedo;  ///< of the medium in the coat
    FloatInput g;
    int maxDepth, samples;

    /// `index`: this coat's.
    template <class Base>
    CoatedBxdf<Base> Over(const Base &base, Float index, const SurfacePoint &point,
                          const SampledWavelengths &lambda) const {
        const SampledSpectrum a = albedo.IsBlack() ? SampledSpectrum(0) : Clamp(albedo(point, lambda), 0, 1);
        return {DielectricBxdf(index, roughness(point)),   base,     thickness(point), a,
                std::clamp(g(point), Float(-1), Float(1)), maxDepth, samples};
    }

    /// Table for CoatedDiffuseBxdf in place of random walks; null if it does not cover the coat.
    std::shared_ptr<const CoatTable> Table() const {
        const std::optional<Float> index = eta.Constant(), depth = thickness.Constant();
        if (!index || !depth || !albedo.IsBlack() || !roughness.IsIsotropic()) return nullptr;
        std::optional<Float> alpha;
        if (auto constant = roughness.Constant()) alpha = constant->AlphaX();
        return CoatTable::Shared(*index, std::max(*depth, Float(0)), alpha);
    }
};

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

/// Reads a BRDF of the RGL database (isotropic, or anisotropic over the whole circle). Throws UserError (no location).
std::shared_ptr<const MeasuredBrdf> ReadMeasuredBrdf(const std::string &path);

}  // namespace pbrt
