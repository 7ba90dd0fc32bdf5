#pragma once
#include "pbrt/textures/texture.h"

namespace pbrt {

class ConstantFloatTexture final : public FloatTexture {
  public:
    explicit ConstantFloatTexture(Float value) : value_(value) {}
    Float Evaluate(const TextureContext &) const override { return value_; }
    std::optional<Float> Constant() const override { return value_; }

  private:
    Float value_;
};

class ConstantSpectrumTexture final : public SpectrumTexture {
  public:
    explicit ConstantSpectrumTexture(SpectrumPtr value) : value_(std::move(value)) {}
    SampledSpectrum Evaluate(const TextureContext &, const SampledWavelengths &lambda) const override {
        return value_->Sample(lambda);
    }
    const Spectrum *Constant() const override { return value_.get(); }

  private:
    SpectrumPtr value_;
};

/// Texture whose Evaluate is `f`. Base is FloatTexture or SpectrumTexture, V its value type, Lambda the further
/// argument of Evaluate, if any.
template <class F, class Base, class V, class... Lambda>
class FunctionTexture final : public Base {
  public:
    FunctionTexture(bool usesFootprint, F f) : f_(std::move(f)), usesFootprint_(usesFootprint) {}
    V Evaluate(const TextureContext &ctx, const Lambda &...lambda) const override { return f_(ctx, lambda...); }
    bool UsesFootprint() const override { return usesFootprint_; }

  private:
    F f_;
    bool usesFootprint_;
};

}  // namespace pbrt
