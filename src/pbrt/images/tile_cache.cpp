#include "pbrt/images/tile_cache.h"

#include <unistd.h>

#include "pbrt/images/image_library.h"

namespace pbrt {

TileCache::TileCache(int megabytes) : tiles_(oiio::Library().MakeTileStore(megabytes, kSize)) {
    static std::atomic<int> caches{0};
    std::error_code failed;
    folder_ = std::filesystem::temp_directory_path(failed) / fmt::format("pbrt_textures_{}_{}", getpid(), caches++);
    registered_.emplace(folder_.string());
    if (!failed) std::filesystem::create_directories(folder_, failed);
    if (failed) throw UserError("{}: {}; $TMPDIR must be a folder.", folder_.string(), failed.message());
}

TileCache::~TileCache() {
    tiles_.reset();
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
}

std::unique_ptr<const TileCache::Stored> TileCache::Store(const std::vector<Image> &images) {
    const std::string path = (folder_ / fmt::format("{}.tif", files_++)).string();
    constexpr oiio::ValueType kTypes[] = {oiio::ValueType::U8, oiio::ValueType::Half, oiio::ValueType::Float};
    std::vector<oiio::Pixels> pixels;
    for (const Image &image : images)
        pixels.push_back({image.Resolution().x, image.Resolution().y, image.ChannelCount(),
                          kTypes[size_t(image.Format())], image.Data()});
    const size_t texelBytes = images[0].Bytes() / (images[0].ValueCount() / images[0].ChannelCount());
    void *file = nullptr;
    try {
        file = tiles_->Add(path, pixels);
    } catch (const std::runtime_error &e) {
        throw UserError("{}: {}.", path, e.what());
    }
    return std::unique_ptr<const Stored>(new Stored(tiles_.get(), file, texelBytes));
}

size_t TileCache::Bytes() const { return tiles_->Bytes(); }

void TileCache::Stored::Get(size_t image, int x, int y, Tile &tile) const {
    tile.Release();
    void *found = tiles_->GetTile(file_, int(image), x, y);
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
