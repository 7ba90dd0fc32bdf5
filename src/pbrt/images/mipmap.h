#pragma once
#include <memory>

#include "pbrt/images/image.h"

namespace pbrt {

enum class TextureFilter { Point, Bilinear, Trilinear, Ewa };
std::optional<TextureFilter> ParseTextureFilter(const std::string &name);

/// Image pyramid with stock pbrt-v4's four filters. Shared between textures that use the same file.
class MipMap {
  public:
    MipMap(Image image, const ColorSpace *colorSpace, TextureFilter filter, WrapMode wrap, Float maxAnisotropy);

    /// Filtered look-ups. st in texture space (0..1 over the image, t downwards as stored); dst0, dst1: footprint axes.
    Float LookupFloat(Point2 st, Vector2 dst0, Vector2 dst1) const;
    Rgb LookupRgb(Point2 st, Vector2 dst0, Vector2 dst1) const;

    int Levels() const { return static_cast<int>(pyramid_.size()); }
    const Image &Level(int i) const { return pyramid_[static_cast<size_t>(i)]; }
    /// The image's own space (from EXR chromaticities), sRGB if not stated.
    const ColorSpace &Space() const { return *colorSpace_; }
    size_t Bytes() const;

  private:
    std::vector<Image> pyramid_;
    const ColorSpace *colorSpace_;
    TextureFilter filter_;
    WrapMode wrap_;
    Float maxAnisotropy_;
};

}  // namespace pbrt
