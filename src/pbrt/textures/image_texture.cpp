#include "pbrt/textures/image_texture.h"

#include <algorithm>

#include "pbrt/core/error.h"
#include "pbrt/core/parallel.h"

namespace pbrt {
namespace {

const std::vector<std::string> kRgb = {"R", "G", "B"};

void RequireRgb(const Image &image, const std::string &path) {
    for (const std::string &channel : kRgb)
        if (image.FindChannel(channel) < 0)
            throw UserError("{}: the image has no channel {}; R, G and B are needed.", path, channel);
}

std::shared_ptr<const MipMap> ReadMipMap(const MipMapKey &key, TileCache *tiles) {
    ImageFile file = ReadImage(key.path, key.encoding);
    if (file.image.ChannelCount() != 1) RequireRgb(file.image, key.path);
    return std::make_shared<MipMap>(std::move(file.image), file.metadata.colorSpace, key.filter, key.wrap,
                                    key.maxAnisotropy, tiles);
}

std::shared_ptr<const Image> ReadLinearRgb(const std::string &path) {
    Image image = ReadImage(path, ColorEncoding{ColorEncoding::Kind::Linear}).image;
    RequireRgb(image, path);
    if (image.Channels() != kRgb) image = image.Extract(kRgb);
    return std::make_shared<const Image>(std::move(image));
}

void Fill(auto &entry, auto &&read) {
    try {
        entry.value = read();
    } catch (const UserError &e) {
        entry.error = e.Diagnostics().empty() ? std::string(e.what()) : e.Diagnostics().front().message;
    }
}

struct Footprint {
    Point2 st;
    Vector2 dst0, dst1;
};

/// Rows are stored from the top, so t is flipped. The footprint is not flipped, as in stock pbrt-v4.
Footprint ImageFootprint(const TextureMapping2D &mapping, const TextureContext &ctx) {
    TexCoord2 c = Map(mapping, ctx);
    return {{c.st.x, 1 - c.st.y}, {c.dsdx, c.dtdx}, {c.dsdy, c.dtdy}};
}

}  // namespace

const ImageCache::Entry<MipMap> *ImageCache::SamePixels(const MipMapKey &key) const {
    MipMapKey first;  // keys are sorted by path first; this is the smallest of a path
    first.path = key.path;
    first.filter = TextureFilter::Point;
    first.maxAnisotropy = -Infinity;
    for (auto it = mipMaps_.lower_bound(first); it != mipMaps_.end() && it->first.path == key.path; ++it)
        if (it->first.HasPixelsOf(key) && (it->second.value || !it->second.error.empty())) return &it->second;
    return nullptr;
}

std::shared_ptr<const MipMap> ImageCache::GetMipMap(const MipMapKey &key) {
    auto [it, isNew] = mipMaps_.try_emplace(key);
    if (isNew) {
        const Entry<MipMap> *same = SamePixels(key);
        if (!same) Fill(it->second, [&] { return ReadMipMap(key, tiles_.get()); });
        else if (same->value) it->second.value = std::make_shared<MipMap>(*same->value, key.filter, key.maxAnisotropy);
        else it->second.error = same->error;
    }
    if (!it->second.value) throw UserError(it->second.error);
    return it->second.value;
}

std::shared_ptr<const Image> ImageCache::GetLinearRgb(const std::string &path) {
    auto [it, isNew] = linear_.try_emplace(path);
    if (isNew) Fill(it->second, [&] { return ReadLinearRgb(path); });
    if (!it->second.value) throw UserError(it->second.error);
    return it->second.value;
}

void ImageCache::Preload(const std::vector<MipMapKey> &keys) {
    std::vector<std::pair<const MipMapKey *, Entry<MipMap> *>> missing;
    for (const MipMapKey &key : keys) {
        auto sameFile = [&](const auto &m) { return m.first->HasPixelsOf(key); };
        if (mipMaps_.contains(key) || SamePixels(key)) continue;
        if (std::any_of(missing.begin(), missing.end(), sameFile)) continue;
        auto [it, isNew] = mipMaps_.try_emplace(key);
        missing.emplace_back(&it->first, &it->second);
    }
    ParallelForEach(int64_t(missing.size()), [&](int64_t i) {
        auto [key, entry] = missing[i];
        Fill(*entry, [&, key = key] { return ReadMipMap(*key, tiles_.get()); });
    });
}

Float ImageFloatTexture::Evaluate(const TextureContext &ctx) const {
    Footprint f = ImageFootprint(overlay.mapping, ctx);
    Float v = overlay.scale * overlay.image->LookupFloat(f.st, f.dst0, f.dst1);
    return overlay.invert ? std::max(Float(0), 1 - v) : v;
}

SampledSpectrum ImageSpectrumTexture::Evaluate(const TextureContext &ctx, const SampledWavelengths &lambda) const {
    Footprint f = ImageFootprint(overlay.mapping, ctx);
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

}  // namespace pbrt
