#include "pbrt/images/tile_cache.h"

#include <OpenImageIO/imagecache.h>
#include <OpenImageIO/imageio.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>

#include "pbrt/core/error.h"

namespace pbrt {

namespace {

OIIO::TypeDesc TypeOf(PixelFormat format) {
    switch (format) {
    case PixelFormat::U8: return OIIO::TypeDesc::UINT8;
    case PixelFormat::Half: return OIIO::TypeDesc::HALF;
    case PixelFormat::Float: break;
    }
    return OIIO::TypeDesc::FLOAT;
}

OIIO::ImageSpec SpecOf(const Image &image) {
    OIIO::ImageSpec spec(image.Resolution().x, image.Resolution().y, image.ChannelCount(), TypeOf(image.Format()));
    spec.tile_width = spec.tile_height = TileCache::kSize;
    spec.alpha_channel = -1;  // values are to come back as they are
    spec["compression"] = "none";
    return spec;
}

OIIO::ImageCache *CacheOf(void *cache) { return static_cast<OIIO::ImageCache *>(cache); }

}  // namespace

struct TileCache::Impl {
    OIIO::ImageCache *cache = nullptr;
    std::filesystem::path folder;
    std::atomic<int> files{0};
};

TileCache::TileCache(int megabytes) : impl_(std::make_unique<Impl>()) {
    static std::atomic<int> caches{0};
    impl_->folder = std::filesystem::temp_directory_path() / fmt::format("pbrt_textures_{}_{}", getpid(), caches++);
    std::error_code failed;
    std::filesystem::create_directories(impl_->folder, failed);
    if (failed) throw UserError(fmt::format("{}: {}.", impl_->folder.string(), failed.message()));
    OIIO::attribute("tiff:half", 1);
    impl_->cache = OIIO::ImageCache::create(false);
    impl_->cache->attribute("max_memory_MB", static_cast<float>(megabytes));
    impl_->cache->attribute("max_open_files", 100);
    impl_->cache->attribute("unassociatedalpha", 1);
}

TileCache::~TileCache() {
    OIIO::ImageCache::destroy(impl_->cache);
    std::error_code ignored;
    std::filesystem::remove_all(impl_->folder, ignored);
}

std::unique_ptr<const TileCache::Stored> TileCache::Store(const std::vector<Image> &images) {
    const std::string path = (impl_->folder / fmt::format("{}.tif", impl_->files++)).string();
    std::vector<OIIO::ImageSpec> specs;
    for (const Image &image : images) specs.push_back(SpecOf(image));
    std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create(path);
    auto check = [&](bool done) {
        if (!done) throw UserError(fmt::format("{}: {}.", path, out ? out->geterror() : OIIO::geterror()));
    };
    check(out != nullptr);
    check(out->open(path, static_cast<int>(specs.size()), specs.data()));
    for (size_t i = 0; i < images.size(); ++i) {
        if (i > 0) check(out->open(path, specs[i], OIIO::ImageOutput::AppendSubimage));
        check(out->write_image(specs[i].format, images[i].Data()));
    }
    check(out->close());
    void *file = impl_->cache->get_image_handle(OIIO::ustring(path));
    PBRT_CHECK_MSG(file != nullptr, "{}", impl_->cache->geterror());
    return std::unique_ptr<const Stored>(
        new Stored(impl_->cache, file, specs[0].format.size() * static_cast<size_t>(specs[0].nchannels)));
}

size_t TileCache::Bytes() const {
    long long bytes = 0;
    impl_->cache->getattribute("stat:cache_memory_used", OIIO::TypeDesc::INT64, &bytes);
    return static_cast<size_t>(bytes);
}

void TileCache::Stored::Get(size_t image, int x, int y, Tile &tile) const {
    tile.Release();
    OIIO::ImageCache *cache = CacheOf(cache_);
    OIIO::ImageCache::Tile *found = cache->get_tile(static_cast<OIIO::ImageCache::ImageHandle *>(file_), nullptr,
                                                    static_cast<int>(image), 0, x, y, 0);
    PBRT_CHECK_MSG(found != nullptr, "a texture tile cannot be read: {}", cache->geterror());
    OIIO::TypeDesc format;
    tile.cache_ = cache_;
    tile.tile_ = found;
    tile.data_ = static_cast<const char *>(cache->tile_pixels(found, format));
    tile.texelBytes_ = texelBytes_;
    tile.image_ = image;
    tile.x_ = x / kSize;
    tile.y_ = y / kSize;
}

void TileCache::Stored::Tile::Release() {
    if (tile_) CacheOf(cache_)->release_tile(static_cast<OIIO::ImageCache::Tile *>(tile_));
    tile_ = nullptr;
}

}  // namespace pbrt
