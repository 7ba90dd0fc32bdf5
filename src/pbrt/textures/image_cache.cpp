#include "pbrt/textures/image_cache.h"

#include "pbrt/core/error.h"
#include "pbrt/core/parallel.h"

namespace pbrt {

namespace {

const std::vector<std::string> kRgb = {"R", "G", "B"};

void RequireRgb(const Image &image, const std::string &path) {
    for (const std::string &channel : kRgb)
        if (image.FindChannel(channel) < 0)
            throw UserError(fmt::format("{}: the image has no channel {}; R, G and B are needed.", path, channel));
}

std::shared_ptr<const MipMap> ReadMipMap(const MipMapKey &key) {
    ImageFile file = ReadImage(key.path, key.encoding);
    if (file.image.ChannelCount() != 1) RequireRgb(file.image, key.path);
    return std::make_shared<MipMap>(std::move(file.image), file.metadata.colorSpace, key.filter, key.wrap,
                                    key.maxAnisotropy);
}

std::shared_ptr<const Image> ReadLinearRgb(const std::string &path) {
    Image image = ReadImage(path, ColorEncoding{ColorEncoding::Kind::Linear}).image;
    RequireRgb(image, path);
    if (image.Channels() != kRgb) image = image.Extract(kRgb);
    return std::make_shared<const Image>(std::move(image));
}

/// Runs `read` and keeps either what it returns or why it failed.
template <class Entry, class Read>
void Fill(Entry &entry, Read &&read) {
    try {
        entry.value = read();
    } catch (const UserError &e) {
        entry.error = e.Diagnostics().empty() ? std::string(e.what()) : e.Diagnostics().front().message;
    }
}

}  // namespace

std::shared_ptr<const MipMap> ImageCache::GetMipMap(const MipMapKey &key) {
    auto [it, isNew] = mipMaps_.try_emplace(key);
    if (isNew) Fill(it->second, [&] { return ReadMipMap(key); });
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
        auto [it, isNew] = mipMaps_.try_emplace(key);
        if (isNew) missing.emplace_back(&it->first, &it->second);
    }
    ParallelForEach(static_cast<int64_t>(missing.size()), [&](int64_t i) {
        auto [key, entry] = missing[static_cast<size_t>(i)];
        Fill(*entry, [&, key = key] { return ReadMipMap(*key); });
    });
}

}  // namespace pbrt
