#pragma once
#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "pbrt/core/files.h"
#include "pbrt/images/image.h"

namespace pbrt {

namespace oiio {
class TileStore;
}

/// Images in tiled files of a temporary folder, removed by the destructor, with up to `megabytes` of tiles in memory.
class TileCache {
  public:
    static constexpr int kSize = 64;  ///< width and height of a tile, in texels
    explicit TileCache(int megabytes);
    ~TileCache();
    TileCache(const TileCache &) = delete;
    TileCache &operator=(const TileCache &) = delete;

    /// Images of one format and channel count in one file. The TileCache must outlive this object.
    class Stored {
      public:
        class Tile {
          public:
            Tile() = default;
            ~Tile() { Release(); }
            Tile(const Tile &) = delete;
            Tile &operator=(const Tile &) = delete;
            bool Holds(size_t image, int x, int y) const {
                return tile_ && image == image_ && x / kSize == x_ && y / kSize == y_;
            }
            /// First channel of a texel in this tile, in the image's format.
            const void *Texel(int x, int y) const { return data_ + (y % kSize * kSize + x % kSize) * texelBytes_; }

          private:
            friend class Stored;
            void Release();
            oiio::TileStore *tiles_ = nullptr;
            void *tile_ = nullptr;
            const char *data_ = nullptr;
            size_t texelBytes_ = 0, image_ = 0;
            int x_ = 0, y_ = 0;  ///< in tiles
        };
        /// Loads the tile with texel (x, y), which must lie inside the image.
        void Get(size_t image, int x, int y, Tile &tile) const;

      private:
        friend class TileCache;
        Stored(oiio::TileStore *tiles, void *file, size_t texelBytes)
            : tiles_(tiles), file_(file), texelBytes_(texelBytes) {}
        oiio::TileStore *tiles_;
        void *file_;
        size_t texelBytes_;
    };
    /// Writes images to disk. Thread-safe. Throws UserError if the folder cannot be written.
    std::unique_ptr<const Stored> Store(const std::vector<Image> &images);
    size_t Bytes() const;

  private:
    std::unique_ptr<oiio::TileStore> tiles_;
    std::filesystem::path folder_;
    std::optional<Temporary> registered_;  ///< the folder
    std::atomic<int> files_{0};
};

}  // namespace pbrt
