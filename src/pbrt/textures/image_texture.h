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
    explicit ImageFloatTexture(ImageOverlay image) : overlay(std::move(image)) {}
    Float Evaluate(const TextureContext &ctx) const override;
    bool UsesFootprint() const override { return true; }  // all filters select a pyramid level

    ImageOverlay overlay;
};

/// Filters RGB and uplifts in the image's own colour space. Albedo is clamped to 1.
class ImageSpectrumTexture final : public SpectrumTexture {
  public:
    ImageSpectrumTexture(ImageOverlay image, SpectrumUse use) : overlay(std::move(image)), use_(use) {}
    SampledSpectrum Evaluate(const TextureContext &ctx, const SampledWavelengths &lambda) const override;
    bool UsesFootprint() const override { return true; }  // all filters select a pyramid level

    ImageOverlay overlay;

  private:
    SpectrumUse use_;
};

}  // namespace pbrt
