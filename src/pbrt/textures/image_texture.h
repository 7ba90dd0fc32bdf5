#pragma once
#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "pbrt/core/error.h"
#include "pbrt/core/parallel.h"
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
    /// Of the same pixels, which are read once for all filters.
    MipMapKey WithoutFilter() const { return {.path = path, .wrap = wrap, .encoding = encoding}; }
};

/// Images of one scene, each read once for all filters. Errors are UserErrors without location, at every lookup.
class ImageCache {
  public:
    /// `megabytes` > 0: big images are stored on disk, with at most this much of them in memory.
    explicit ImageCache(int megabytes = 0) : tiles_(megabytes > 0 ? std::make_unique<TileCache>(megabytes) : nullptr) {}
    std::shared_ptr<const MipMap> GetMipMap(const MipMapKey &key) {
        auto [it, isNew] = mipMaps_.try_emplace(key.WithoutFilter());
        if (isNew) Fill(it->second, [&] { return ReadMipMap(key, tiles_.get()); });
        if (!it->second.value) throw UserError(it->second.error);
        return std::make_shared<MipMap>(*it->second.value, key.filter, key.maxAnisotropy);
    }
    /// R, G and B of a file; 8 or 16 bit values are taken as linear.
    std::shared_ptr<const Image> GetLinearRgb(const std::string &path) {
        auto [it, isNew] = linear_.try_emplace(path);
        if (isNew) Fill(it->second, [&] { return ReadLinearRgb(path); });
        if (!it->second.value) throw UserError(it->second.error);
        return it->second.value;
    }
    void Preload(const std::vector<MipMapKey> &keys) {
        std::vector<std::pair<const MipMapKey *, Entry<MipMap> *>> missing;
        for (const MipMapKey &key : keys)
            if (auto [it, isNew] = mipMaps_.try_emplace(key.WithoutFilter()); isNew)
                missing.emplace_back(&it->first, &it->second);
        ParallelForEach(int64_t(missing.size()), [&](int64_t i) {
            auto [key, entry] = missing[i];
            Fill(*entry, [&, key = key] { return ReadMipMap(*key, tiles_.get()); });
        });
    }

  private:
    template <class T>
    struct Entry {
        std::shared_ptr<const T> value;
        std::string error;
    };
    static void RequireRgb(const Image &image, const std::string &path) {
        for (const char *channel : {"R", "G", "B"})
            if (image.FindChannel(channel) < 0)
                throw UserError("{}: the image has no channel {}; R, G and B are needed.", path, channel);
    }
    static std::shared_ptr<const MipMap> ReadMipMap(const MipMapKey &key, TileCache *tiles) {
        ImageFile file = ReadImage(key.path, key.encoding);
        if (file.image.ChannelCount() != 1) RequireRgb(file.image, key.path);
        return std::make_shared<MipMap>(std::move(file.image), file.metadata.colorSpace, key.filter, key.wrap,
                                        key.maxAnisotropy, tiles);
    }
    static std::shared_ptr<const Image> ReadLinearRgb(const std::string &path) {
        const Image image = ReadImage(path, ColorEncoding{ColorEncoding::Kind::Linear}).image;
        RequireRgb(image, path);
        return std::make_shared<const Image>(image.Extract({"R", "G", "B"}));
    }
    static void Fill(auto &entry, auto &&read) {
        try {
            entry.value = read();
        } catch (const UserError &e) {
            entry.error = e.Diagnostics().empty() ? std::string(e.what()) : e.Diagnostics().front().message;
        }
    }

    std::unique_ptr<TileCache> tiles_;
    std::map<MipMapKey, Entry<MipMap>> mipMaps_;  ///< by WithoutFilter
    std::map<std::string, Entry<Image>> linear_;
};

/// Image mapped to a surface. t = 0 is the bottom row. Values are scaled, then inverted (1 - v, at least 0).
struct ImageOverlay {
    std::shared_ptr<const MipMap> image;
    TextureMapping2D mapping;
    Float scale = 1;
    bool invert = false;

    struct Footprint {
        Point2 st;
        Vector2 dst0, dst1;
    };
    /// Rows are stored from the top, so t is flipped. The footprint is not flipped, as in stock pbrt-v4.
    Footprint FootprintAt(const TextureContext &ctx) const {
        TexCoord2 c = Map(mapping, ctx);
        return {{c.st.x, 1 - c.st.y}, {c.dsdx, c.dtdx}, {c.dsdy, c.dtdy}};
    }
};

class ImageFloatTexture final : public FloatTexture {
  public:
    explicit ImageFloatTexture(ImageOverlay image) : overlay(std::move(image)) {}
    Float Evaluate(const TextureContext &ctx) const override {
        ImageOverlay::Footprint f = overlay.FootprintAt(ctx);
        Float v = overlay.scale * overlay.image->LookupFloat(f.st, f.dst0, f.dst1);
        return overlay.invert ? std::max(Float(0), 1 - v) : v;
    }
    bool UsesFootprint() const override { return true; }  // all filters select a pyramid level

    ImageOverlay overlay;
};

/// Filters RGB and uplifts in the image's own colour space. Albedo is clamped to 1.
class ImageSpectrumTexture final : public SpectrumTexture {
  public:
    ImageSpectrumTexture(ImageOverlay image, SpectrumUse use) : overlay(std::move(image)), use_(use) {}
    SampledSpectrum Evaluate(const TextureContext &ctx, const SampledWavelengths &lambda) const override {
        ImageOverlay::Footprint f = overlay.FootprintAt(ctx);
        Rgb rgb = overlay.scale * overlay.image->LookupRgb(f.st, f.dst0, f.dst1);
        if (overlay.invert) rgb = Rgb(1) - rgb;
        rgb = glm::max(rgb, Rgb(0));
        const ColorSpace &space = overlay.image->Space();
        switch (use_) {
            case SpectrumUse::Albedo: return space.ToPolynomial(glm::min(rgb, Rgb(1))).Sample(lambda);
            case SpectrumUse::Unbounded: return RgbUnboundedSpectrum(space, rgb).Sample(lambda);
            case SpectrumUse::Illuminant: break;
        }
        return RgbIlluminantSpectrum(space, rgb).Sample(lambda);
    }
    bool UsesFootprint() const override { return true; }  // all filters select a pyramid level

    ImageOverlay overlay;

  private:
    SpectrumUse use_;
};

}  // namespace pbrt
