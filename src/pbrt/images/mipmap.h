#pragma once
#include <memory>

#include "pbrt/images/image.h"
#include "pbrt/images/tile_cache.h"

namespace pbrt {

enum class TextureFilter { Point, Bilinear, Trilinear, Ewa };

/// Levels of an image pyramid, finest first, each half as large as the one before, down to one pixel, all in the
/// format of `image`. Resolutions that are no powers of two are first resampled to the next larger ones.
std::vector<Image> BuildPyramid(Image image, WrapMode wrap);

/// Image pyramid with stock pbrt-v4's four filters. Shared between textures that use the same file.
class MipMap {
  public:
    /// Images of several channels need R, G, B, else UserError (which does not know the file's name); A is kept unless
    /// it is 1 everywhere; other channels are dropped. `colorSpace` may be null.
    /// With a tile cache, which must outlive the map, big levels go to disk.
    MipMap(Image image, const ColorSpace *colorSpace, TextureFilter filter, WrapMode wrap, Float maxAnisotropy,
           TileCache *tiles = nullptr);
    /// The same image, filtered in another way.
    MipMap(const MipMap &image, TextureFilter filter, Float maxAnisotropy);
    MipMap(const MipMap &) = delete;
    MipMap &operator=(const MipMap &) = delete;

    /// Filtered look-ups. st in texture space (0..1 over the image, t downwards as stored); dst0, dst1: footprint axes.
    /// Float: one channel as it is; of colour images the mean of R, G, B or, if there is one, the alpha channel. As in
    /// stock pbrt-v4, point and EWA look-ups and very wide footprints read the first channel instead.
    Float LookupFloat(Point2 st, Vector2 dst0, Vector2 dst1) const;
    Rgb LookupRgb(Point2 st, Vector2 dst0, Vector2 dst1) const;

    int Levels() const { return static_cast<int>(view_.levels.size()); }
    /// Only for maps without a tile cache.
    const Image &Level(int i) const { return pixels_->levels[i]; }
    /// The image's own space (from EXR chromaticities), sRGB if not stated.
    const ColorSpace &Space() const { return *colorSpace_; }
    bool HasAlpha() const { return view_.channels == 4; }
    /// Bytes in memory, without those of tiles. Maps that share an image count it each.
    size_t Bytes() const;

    /// One level as the look-ups see it. Width and height are powers of two.
    struct LevelView {
        const void *texels;  ///< null: on disk
        int width, height;
    };
    /// What the look-ups need, apart from the images.
    struct View {
        std::vector<LevelView> levels;
        PixelFormat format = PixelFormat::Float;
        size_t channels = 1;
        const float *decode = nullptr;             ///< linear values of the 256 bytes; null unless U8
        const TileCache::Stored *tiles = nullptr;  ///< the first levels, if they are on disk
        TextureFilter filter = TextureFilter::Bilinear;
        WrapMode wrap = WrapMode::Repeat;
        Float maxAnisotropy = 8;
    };

  private:
    /// Levels that are on disk are empty images.
    struct Pixels {
        std::vector<Image> levels;
        std::unique_ptr<const TileCache::Stored> tiles;
    };
    std::shared_ptr<const Pixels> pixels_;
    const ColorSpace *colorSpace_;
    View view_;
};

}  // namespace pbrt
