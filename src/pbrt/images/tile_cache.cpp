#include "pbrt/images/tile_cache.h"

#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <optional>

#include "pbrt/core/error.h"
#include "pbrt/core/temporaries.h"
#include "pbrt/images/image_library.h"

namespace pbrt {

namespace {

oiio::ValueType TypeOf(PixelFormat format) {
    switch (format) {
        case PixelFormat::U8: return oiio::ValueType::U8;
        case PixelFormat::Half: return oiio::ValueType::Half;
        case PixelFormat::Float: break;
    }
    return oiio::ValueType::Float;
}

}  // namespace

struct TileCache::Impl {
    std::unique_ptr<oiio::TileStore> tiles;
    std::filesystem::path folder;
    std::optional<Temporary> registered;  ///< the folder
    std::atomic<int> files{0};
};

TileCache::TileCache(int megabytes) : impl_(std::make_unique<Impl>()) {
    impl_->tiles = oiio::Library().MakeTileStore(megabytes, kSize);
    static std::atomic<int> caches{0};
    impl_->folder = std::filesystem::temp_directory_path() / fmt::format("pbrt_textures_{}_{}", getpid(), caches++);
    impl_->registered.emplace(impl_->folder.string());
    std::error_code failed;
    std::filesystem::create_directories(impl_->folder, failed);
    if (failed) throw UserError(fmt::format("{}: {}.", impl_->folder.string(), failed.message()));
}

TileCache::~TileCache() {
    impl_->tiles.reset();
    std::error_code ignored;
    std::filesystem::remove_all(impl_->folder, ignored);
}

std::unique_ptr<const TileCache::Stored> TileCache::Store(const std::vector<Image> &images) {
    const std::string path = (impl_->folder / fmt::format("{}.tif", impl_->files++)).string();
    std::vector<oiio::Pixels> pixels;
    for (const Image &image : images)
        pixels.push_back(
            {image.Resolution().x, image.Resolution().y, image.ChannelCount(), TypeOf(image.Format()), image.Data()});
    const size_t texelBytes = images[0].Bytes() / (images[0].ValueCount() / images[0].ChannelCount());
    void *file = nullptr;
    try {
        file = impl_->tiles->Add(path, pixels);
    } catch (const std::runtime_error &e) {
        throw UserError(fmt::format("{}: {}.", path, e.what()));
    }
    return std::unique_ptr<const Stored>(new Stored(impl_->tiles.get(), file, texelBytes));
}

size_t TileCache::Bytes() const { return impl_->tiles->Bytes(); }

void TileCache::Stored::Get(size_t image, int x, int y, Tile &tile) const {
    tile.Release();
    void *found = tiles_->GetTile(file_, static_cast<int>(image), x, y);
    PBRT_CHECK_MSG(found != nullptr, "a texture tile cannot be read: {}", tiles_->Error());
    tile.tiles_ = tiles_;
    tile.tile_ = found;
    tile.data_ = static_cast<const char *>(tiles_->PixelsOf(found));
    tile.texelBytes_ = texelBytes_;
    tile.image_ = image;
    tile.x_ = x / kSize;
    tile.y_ = y / kSize;
}

void TileCache::Stored::Tile::Release() {
    if (tile_) tiles_->Release(tile_);
    tile_ = nullptr;
}

}  // namespace pbrt
