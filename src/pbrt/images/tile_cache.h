#pragma once
#include <memory>
#include <vector>

#include "pbrt/images/image.h"

namespace pbrt {

/// Images that live on disk: written to tiled files in a temporary folder, of whose tiles as many as fit a limit of
/// memory are kept, by OpenImageIO's cache. The folder goes with the object.
class TileCache {
  public:
    explicit TileCache(int megabytes);
    ~TileCache();
    TileCache(const TileCache &) = delete;
    TileCache &operator=(const TileCache &) = delete;

    /// Several images of one format and number of channels in one file. The cache must outlive it.
    class Stored {
      public:
        /// Keeps a tile in memory while it lives.
        class Texel {
          public:
            ~Texel();
            Texel(const Texel &) = delete;
            Texel &operator=(const Texel &) = delete;
            /// The first channel of the texel, in the image's format.
            const void *Data() const { return data_; }

          private:
            friend class Stored;
            Texel(void *cache, void *tile, const void *data) : cache_(cache), tile_(tile), data_(data) {}
            void *cache_, *tile_;
            const void *data_;
        };
        /// (x, y) inside the image.
        Texel At(size_t image, int x, int y) const;

      private:
        friend class TileCache;
        Stored(void *cache, void *file, size_t texelBytes) : cache_(cache), file_(file), texelBytes_(texelBytes) {}
        void *cache_, *file_;
        size_t texelBytes_;
    };
    /// Thread-safe. Throws UserError if the folder cannot be written.
    std::unique_ptr<const Stored> Store(const std::vector<Image> &images);
    /// Bytes of tiles now in memory.
    size_t Bytes() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace pbrt
