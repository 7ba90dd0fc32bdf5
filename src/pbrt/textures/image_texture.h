#pragma once
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "pbrt/images/mipmap.h"
#include "pbrt/spectra/spectrum_params.h"
#include "pbrt/textures/texture_mapping.h"

namespace pbrt {

struct MipMapKey {
    std::string path;
    TextureFilter filter = TextureFilter::Bilinear;
    WrapMode wrap = WrapMode::Repeat;
    Float maxAnisotropy = 8;
    std::optional<ColorEncoding> encoding{};  ///< nullopt: the format's default

    auto operator<=>(const MipMapKey &) const = default;
    bool HasPixelsOf(const MipMapKey &o) const { return path == o.path && wrap == o.wrap && encoding == o.encoding; }
};

/// Images of one scene, each read once regardless of filtering. Reading errors are UserErrors without location,
/// rethrown on every lookup.
class ImageCache {
  public:
    /// `megabytes` > 0: big images are stored on disk, with at most this much of them in memory.
    explicit ImageCache(int megabytes = 0) : tiles_(megabytes > 0 ? std::make_unique<TileCache>(megabytes) : nullptr) {}
    std::shared_ptr<const MipMap> GetMipMap(const MipMapKey &key);
    /// R, G and B of a file; 8 or 16 bit values are taken as linear.
    std::shared_ptr<const Image> GetLinearRgb(const std::string &path);
    void Preload(const std::vector<MipMapKey> &keys);

  private:
    template <class T>
    struct Entry {
        std::shared_ptr<const T> value;
        std::string error;
    };
    /// Entry of another key with the same pixels; null if there is none.
    const Entry<MipMap> *SamePixels(const MipMapKey &key) const;
    std::unique_ptr<TileCache> tiles_;
    std::map<MipMapKey, Entry<MipMap>> mipMaps_;
    std::map<std::string, Entry<Image>> linear_;
};

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
