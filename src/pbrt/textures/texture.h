#pragma once
#include <memory>
#include <optional>

#include "pbrt/shapes/shape.h"
#include "pbrt/spectra/spectrum.h"

namespace pbrt {

/// Arguments of texture evaluation. Filter footprint: derivatives per pixel step; 0: point sampling.
struct TextureContext {
    Point3 p{};
    Vector3 dpdx{}, dpdy{};
    Normal3 n{};
    Point2 uv{};
    Float dudx = 0, dudy = 0, dvdx = 0, dvdy = 0;

    TextureContext() = default;
    explicit TextureContext(const SurfacePoint &s)
        : p(s.p), dpdx(s.dpdx), dpdy(s.dpdy), n(s.n), uv(s.uv), dudx(s.dudx), dudy(s.dudy), dvdx(s.dvdx), dvdy(s.dvdy) {
    }
};

class FloatTexture {
  public:
    virtual ~FloatTexture() = default;
    virtual Float Evaluate(const TextureContext &ctx) const = 0;
    virtual std::optional<Float> Constant() const { return {}; }  ///< the value, if it is the same everywhere
    virtual bool UsesFootprint() const { return false; }          ///< Evaluate reads the derivatives of its context
};
using FloatTexturePtr = std::shared_ptr<const FloatTexture>;

/// Created per use (albedo, unbounded or illuminant), which determines the uplifting of RGB.
class SpectrumTexture {
  public:
    virtual ~SpectrumTexture() = default;
    virtual SampledSpectrum Evaluate(const TextureContext &ctx, const SampledWavelengths &lambda) const = 0;
    virtual const Spectrum *Constant() const { return nullptr; }  ///< the same, owned by the texture, else null
    virtual bool UsesFootprint() const { return false; }          ///< Evaluate reads the derivatives of its context
};
using SpectrumTexturePtr = std::shared_ptr<const SpectrumTexture>;

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

/// Texture whose Evaluate is `f`. Base: FloatTexture or SpectrumTexture; V: value type; Lambda: further arguments.
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
