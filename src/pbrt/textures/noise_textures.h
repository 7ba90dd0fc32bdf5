#pragma once
#include <utility>

#include "pbrt/textures/noise.h"
#include "pbrt/textures/texture_mapping.h"

namespace pbrt {

/// Random dots of radius 0.35 in about 40 % of the unit cells around integer (s, t).
class DotPattern {
  public:
    explicit DotPattern(TextureMapping2D mapping) : mapping_(std::move(mapping)) {}
    bool InDot(const TextureContext &ctx) const;

  private:
    TextureMapping2D mapping_;
};

template <class Base, class V, class... Lambda>
class DotsTexture final : public Base {
  public:
    using Ptr = std::shared_ptr<const Base>;
    DotsTexture(DotPattern pattern, Ptr dot, Ptr ground)
        : pattern_(std::move(pattern)), dot_(std::move(dot)), ground_(std::move(ground)) {}
    V Evaluate(const TextureContext &ctx, const Lambda &...lambda) const override {
        return (pattern_.InDot(ctx) ? dot_ : ground_)->Evaluate(ctx, lambda...);
    }
    bool UsesFootprint() const override { return dot_->UsesFootprint() || ground_->UsesFootprint(); }

  private:
    DotPattern pattern_;
    Ptr dot_, ground_;
};

/// A sum of NoiseOctaves, evaluated in texture space.
template <Float (NoiseOctaves::*Sum)(const Point3 &, const Vector3 &, const Vector3 &) const>
class OctavesTexture final : public FloatTexture {
  public:
    OctavesTexture(const PointMapping &mapping, const NoiseOctaves &octaves) : mapping_(mapping), octaves_(octaves) {}
    Float Evaluate(const TextureContext &ctx) const override {
        TexCoord3 c = mapping_.Map(ctx);
        return (octaves_.*Sum)(c.p, c.dpdx, c.dpdy);
    }
    bool UsesFootprint() const override { return true; }

  private:
    PointMapping mapping_;
    NoiseOctaves octaves_;
};
using FbmTexture = OctavesTexture<&NoiseOctaves::Signed>;
using WrinkledTexture = OctavesTexture<&NoiseOctaves::Creased>;

/// Waves with height modulated by low-frequency noise.
class WindyTexture final : public FloatTexture {
  public:
    explicit WindyTexture(const PointMapping &mapping) : mapping_(mapping) {}
    Float Evaluate(const TextureContext &ctx) const override;
    bool UsesFootprint() const override { return true; }

  private:
    PointMapping mapping_;
};

struct MarbleSettings {
    NoiseOctaves octaves;
    Float scale = 1;               ///< factor of positions in texture space
    Float variation = Float(0.2);  ///< amplitude of the veins' distortion
};

/// Veins alternating along y of texture space. Always uplifted as a reflectance, regardless of its use.
class MarbleTexture final : public SpectrumTexture {
  public:
    MarbleTexture(const PointMapping &mapping, const MarbleSettings &settings)
        : mapping_(mapping), settings_(settings) {}
    SampledSpectrum Evaluate(const TextureContext &ctx, const SampledWavelengths &lambda) const override;
    bool UsesFootprint() const override { return true; }

  private:
    PointMapping mapping_;
    MarbleSettings settings_;
};

}  // namespace pbrt
