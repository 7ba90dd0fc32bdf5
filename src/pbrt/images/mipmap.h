#pragma once
#include <memory>

#include "pbrt/images/image.h"
#include "pbrt/images/tile_cache.h"

namespace pbrt {

enum class TextureFilter { Point, Bilinear, Trilinear, Ewa };

/// Pyramid levels, finest first, each half the size of the previous, down to one pixel, in the format of `image`.
/// Non-power-of-two resolutions are first resampled to the next larger power.
std::vector<Image> BuildPyramid(Image image, WrapMode wrap);

/// Image pyramid with stock pbrt-v4's four filters. Shared between textures of the same file.
class MipMap {
  public:
    /// Images of several channels need R, G, B, else UserError (without file name); A is kept unless it is 1
    /// everywhere; other channels are dropped. `colorSpace` may be null. With a tile cache, which must outlive the map,
    /// big levels are stored on disk.
    MipMap(Image image, const ColorSpace *colorSpace, TextureFilter filter, WrapMode wrap, Float maxAnisotropy,
           TileCache *tiles = nullptr);
    MipMap(const MipMap &image, TextureFilter filter, Float maxAnisotropy);
    MipMap(const MipMap &) = delete;
    MipMap &operator=(const MipMap &) = delete;

    /// Filtered lookups. st in [0, 1] over the image, t downwards as stored; dst0, dst1: footprint axes. The Float
    /// version returns a single channel; for colour images the alpha channel if present, else the mean of R, G, B. As
    /// in stock pbrt-v4, point and EWA lookups and very wide footprints read the first channel instead.
    Float LookupFloat(Point2 st, Vector2 dst0, Vector2 dst1) const;
    Rgb LookupRgb(Point2 st, Vector2 dst0, Vector2 dst1) const;

    int Levels() const { return int(view_.levels.size()); }
    /// Empty if on disk.
    const Image &Level(int i) const { return pixels_->levels[i]; }
    /// Colour space from EXR chromaticities, sRGB if unspecified.
    const ColorSpace &Space() const { return *colorSpace_; }

    /// Level data for lookups. Width and height are powers of two.
    struct LevelView {
        const void *texels;  ///< null: on disk
        int width, height;
    };
    struct View {
        std::vector<LevelView> levels;
        PixelFormat format = PixelFormat::Float;
        size_t channels = 1;
        const float *decode = nullptr;             ///< linear values of the 256 bytes; null unless U8
        const TileCache::Stored *tiles = nullptr;  ///< the first levels, if stored on disk
        TextureFilter filter = TextureFilter::Bilinear;
        WrapMode wrap = WrapMode::Repeat;
        Float maxAnisotropy = 8;
    };

  private:
    /// Levels on disk are empty images.
    struct Pixels {
        std::vector<Image> levels;
        std::unique_ptr<const TileCache::Stored> tiles;
    };
    std::shared_ptr<const Pixels> pixels_;
    const ColorSpace *colorSpace_;
    View view_;
};

}  // namespace pbrt
