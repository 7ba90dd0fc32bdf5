#pragma once
#include "pbrt/images/mipmap.h"
#include "pbrt/spectra/spectrum_params.h"
#include "pbrt/textures/texture_mapping.h"

namespace pbrt {

/// Image mapped to a surface. t = 0 is the bottom row. Values are scaled, then inverted (1 - v, at least 0).
struct ImageOverlay {
    std::shared_ptr<const MipMap> image;
    TextureMapping2D mapping;
    Float scale = 1;
    bool invert = false;
};

class ImageFloatTexture final : public FloatTexture {
  public:
    explicit ImageFloatTexture(ImageOverlay overlay) : overlay_(std::move(overlay)) {}
    Float Evaluate(const TextureContext &ctx) const override;
    bool UsesFootprint() const override { return true; }  // all filters select a pyramid level
    /// Returns a copy with the scale multiplied by `factor`, before the inversion.
    std::shared_ptr<const ImageFloatTexture> Scaled(Float factor) const;

  private:
    ImageOverlay overlay_;
};

/// Filters RGB and uplifts in the image's own colour space. Albedo is clamped to 1.
class ImageSpectrumTexture final : public SpectrumTexture {
  public:
    ImageSpectrumTexture(ImageOverlay overlay, SpectrumUse use) : overlay_(std::move(overlay)), use_(use) {}
    SampledSpectrum Evaluate(const TextureContext &ctx, const SampledWavelengths &lambda) const override;
    bool UsesFootprint() const override { return true; }  // all filters select a pyramid level
    std::shared_ptr<const ImageSpectrumTexture> Scaled(Float factor) const;

  private:
    ImageOverlay overlay_;
    SpectrumUse use_;
};

}  // namespace pbrt
