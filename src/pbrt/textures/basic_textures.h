#pragma once
#include <array>
#include <utility>

#include "pbrt/textures/texture_mapping.h"

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

// Classes of both families are templates: Base is FloatTexture or SpectrumTexture, V the value type, Lambda the further
// argument of Evaluate, if any.
template <template <class, class, class...> class T>
using FloatFamily = T<FloatTexture, Float>;
template <template <class, class, class...> class T>
using SpectrumFamily = T<SpectrumTexture, SampledSpectrum, SampledWavelengths>;

/// (1 - w) a + w b; evaluates only textures of non-zero weight.
template <class V, class Base, class... Lambda>
V BlendTextures(Float w, const Base &a, const Base &b, const TextureContext &ctx, const Lambda &...lambda) {
    if (w == 0) return a.Evaluate(ctx, lambda...);
    if (w == 1) return b.Evaluate(ctx, lambda...);
    return a.Evaluate(ctx, lambda...) * (1 - w) + b.Evaluate(ctx, lambda...) * w;
}

template <class Base, class V, class... Lambda>
class ScaleTexture final : public Base {
  public:
    using Ptr = std::shared_ptr<const Base>;
    ScaleTexture(Ptr texture, FloatTexturePtr scale) : texture_(std::move(texture)), scale_(std::move(scale)) {}
    V Evaluate(const TextureContext &ctx, const Lambda &...lambda) const override {
        Float s = scale_->Evaluate(ctx);
        if (s == 0) return V(Float(0));
        return texture_->Evaluate(ctx, lambda...) * s;
    }
    bool UsesFootprint() const override { return texture_->UsesFootprint() || scale_->UsesFootprint(); }

  private:
    Ptr texture_;
    FloatTexturePtr scale_;
};

template <class Base, class V, class... Lambda>
class MixTexture final : public Base {
  public:
    using Ptr = std::shared_ptr<const Base>;
    MixTexture(Ptr first, Ptr second, FloatTexturePtr amount)
        : first_(std::move(first)), second_(std::move(second)), amount_(std::move(amount)) {}
    V Evaluate(const TextureContext &ctx, const Lambda &...lambda) const override {
        return BlendTextures<V>(amount_->Evaluate(ctx), *first_, *second_, ctx, lambda...);
    }
    bool UsesFootprint() const override {
        return first_->UsesFootprint() || second_->UsesFootprint() || amount_->UsesFootprint();
    }

  private:
    Ptr first_, second_;
    FloatTexturePtr amount_;
};

/// Blends the first texture, where the normal is parallel to `direction` (rendering space), to the second where
/// perpendicular.
template <class Base, class V, class... Lambda>
class DirectionMixTexture final : public Base {
  public:
    using Ptr = std::shared_ptr<const Base>;
    DirectionMixTexture(Ptr first, Ptr second, const Vector3 &direction)
        : first_(std::move(first)), second_(std::move(second)), direction_(Normalize(direction)) {}
    V Evaluate(const TextureContext &ctx, const Lambda &...lambda) const override {
        return BlendTextures<V>(AbsDot(ctx.n, direction_), *second_, *first_, ctx, lambda...);
    }
    bool UsesFootprint() const override { return first_->UsesFootprint() || second_->UsesFootprint(); }

  private:
    Ptr first_, second_;
    Vector3 direction_;
};

/// Bilinear interpolation of corner constants over (s, t), in the order v00, v01, v10, v11 (s first).
template <class Base, class V, class... Lambda>
class BilerpTexture final : public Base {
  public:
    using Ptr = std::shared_ptr<const Base>;
    BilerpTexture(TextureMapping2D mapping, std::array<Ptr, 4> corners)
        : mapping_(std::move(mapping)), corners_(std::move(corners)) {}
    V Evaluate(const TextureContext &ctx, const Lambda &...lambda) const override {
        Point2 st = Map(mapping_, ctx).st;
        Float ws[2] = {1 - st.x, st.x}, wt[2] = {1 - st.y, st.y};
        V sum(Float(0));
        for (size_t i = 0; i < 4; ++i) sum += corners_[i]->Evaluate(ctx, lambda...) * (ws[i >> 1] * wt[i & 1]);
        return sum;
    }

  private:
    TextureMapping2D mapping_;
    std::array<Ptr, 4> corners_;
};

}  // namespace pbrt
