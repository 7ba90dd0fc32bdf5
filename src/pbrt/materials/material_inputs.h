#pragma once

#include "pbrt/bxdfs/layered.h"
#include "pbrt/spectra/color_space.h"
#include "pbrt/textures/texture_factory.h"

namespace pbrt {

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

/// Spectrum parameter of a material. Constant spectra are sampled without texture evaluation, uplifted reflectances
/// without a virtual call.
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

}  // namespace pbrt
