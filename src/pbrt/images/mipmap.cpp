#include "pbrt/images/mipmap.h"

#include <Imath/half.h>

#include <array>
#include <bit>
#include <cmath>
#include <type_traits>
#include <variant>

namespace pbrt {
namespace {

/// N: 1 or 3.
template <int N>
using Texel = glm::vec<N, Float>;

// exp(-2 r^2) shifted to reach 0 at r^2 = 1 (Greene and Heckbert 1986), tabulated over r^2.
constexpr int GaussianEntries = 128;
const std::array<Float, GaussianEntries> GaussianTable = [] {
    std::array<Float, GaussianEntries> table{};
    for (int i = 0; i < GaussianEntries; ++i) {
        Float r2 = Float(i) / (GaussianEntries - 1);
        table[i] = std::exp(-2 * r2) - std::exp(Float(-2));
    }
    return table;
}();

// Twice the largest footprint component; stock pbrt-v4 picks the level of this texel spacing, for 1 the last one. At
// least 1e-8, also for NaN.
Float Width(Vector2 dst0, Vector2 dst1) {
    const Float width = 2 * std::max({std::abs(dst0.x), std::abs(dst0.y), std::abs(dst1.x), std::abs(dst1.y)});
    return width > Float(1e-8) ? width : Float(1e-8);
}

int FloorLog2(Float v) { return int(std::bit_cast<uint32_t>(v) >> 23) - 127; }

int ToPixel(Float v) { return int(std::clamp(v, Float(-1e9), Float(1e9))); }

// Lookups of N successive channels from `first` on. Stored: uint8_t, uint16_t for halves, or float.
template <class Stored, int N, bool Tiled>
class Reader {
  public:
    Reader(const MipMap::View &view, size_t first) : view_(view), first_(first) {}

    Texel<N> Filter(Point2 st, Vector2 dst0, Vector2 dst1) const {
        if (view_.filter == TextureFilter::Ewa) return Ewa(st, dst0, dst1);
        const int last = int(view_.levels.size()) - 1;
        const Float width = Width(dst0, dst1);
        if (width >= 1) return At(last, {0, 0});
        if (view_.filter != TextureFilter::Trilinear) {
            const int level = std::max(0, last + FloorLog2(width));
            return view_.filter == TextureFilter::Bilinear ? Bilinear(level, st) : Nearest(level, st);
        }
        const Float level = Float(last) + std::log2(width);
        // No interpolation between levels 0 and 1, as in stock pbrt-v4.
        if (level < 1) return Bilinear(0, st);
        const int whole = std::min(int(level), last - 1);
        return Lerp(level - Float(whole), Bilinear(whole, st), Bilinear(whole + 1, st));
    }

  private:
    Float Linear(uint8_t byte) const { return view_.decode[byte]; }
    static Float Linear(uint16_t half) { return imath_half_to_float(half); }
    static Float Linear(float value) { return value; }
    Texel<N> Decode(const void *texels, size_t i) const {
        const Stored *data = static_cast<const Stored *>(texels) + i;
        if constexpr (N == 1) return Texel<N>(Linear(*data));
        else return {Linear(data[0]), Linear(data[1]), Linear(data[2])};
    }

    Texel<N> Load(const MipMap::LevelView &level, int x, int y) const {
        if constexpr (Tiled) {
            if (!level.texels) {
                const size_t index = &level - view_.levels.data();
                if (!tile_.Holds(index, x, y)) view_.tiles->Get(index, x, y, tile_);
                return Decode(tile_.Texel(x, y), first_);
            }
        }
        const size_t i = (size_t(y) * level.width + x) * view_.channels + first_;
        return Decode(level.texels, i);
    }

    Texel<N> At(const MipMap::LevelView &level, Point2i p) const {
        if (view_.wrap == WrapMode::Repeat) return Load(level, p.x & (level.width - 1), p.y & (level.height - 1));
        if (!RemapPixel(p, {level.width, level.height}, view_.wrap)) return Texel<N>(0);
        return Load(level, p.x, p.y);
    }
    Texel<N> At(int level, Point2i p) const { return At(view_.levels[level], p); }

    Texel<N> Nearest(int i, Point2 st) const {
        const MipMap::LevelView &level = view_.levels[i];
        return At(level, {ToPixel(std::round(st.x * Float(level.width) - Float(0.5))),
                          ToPixel(std::round(st.y * Float(level.height) - Float(0.5)))});
    }

    Texel<N> Bilinear(int index, Point2 st) const {
        const MipMap::LevelView &level = view_.levels[index];
        const Float x = st.x * Float(level.width) - Float(0.5);
        const Float y = st.y * Float(level.height) - Float(0.5);
        const Float fx = std::floor(x), fy = std::floor(y);
        const Float dx = x - fx, dy = y - fy;
        const Point2i p(ToPixel(fx), ToPixel(fy));
        Texel<N> sum(0);
        const auto add = [&](auto &&at) {
            sum += (1 - dx) * (1 - dy) * at(0, 0);
            sum += dx * (1 - dy) * at(1, 0);
            sum += (1 - dx) * dy * at(0, 1);
            sum += dx * dy * at(1, 1);
        };
        if (view_.wrap == WrapMode::Repeat) {
            const int xs[] = {p.x & (level.width - 1), (p.x + 1) & (level.width - 1)};
            const int ys[] = {p.y & (level.height - 1), (p.y + 1) & (level.height - 1)};
            add([&](int i, int j) { return Load(level, xs[i], ys[j]); });
        } else if (p.x >= 0 && p.y >= 0 && p.x + 1 < level.width && p.y + 1 < level.height) {
            add([&](int i, int j) { return Load(level, p.x + i, p.y + j); });
        } else {
            add([&](int i, int j) { return At(level, p + Point2i(i, j)); });
        }
        return sum;
    }

    // Elliptically weighted average (Greene and Heckbert 1986; Heckbert 1989, section 3.5.9), between two levels.
    Texel<N> Ewa(Point2 st, Vector2 dst0, Vector2 dst1) const {
        Vector2 major = dst0, minor = dst1;
        Float longer = glm::length(major), shorter = glm::length(minor);
        if (longer < shorter) {
            std::swap(major, minor);
            std::swap(longer, shorter);
        }
        if (!(shorter > 0)) return Bilinear(0, st);
        const int last = int(view_.levels.size()) - 1;
        if (!std::isfinite(longer)) return At(last, {0, 0});
        // Widens thin ellipses, which blurs but bounds the cost.
        if (shorter * view_.maxAnisotropy < longer) {
            const Float scale = longer / (shorter * view_.maxAnisotropy);
            minor *= scale;
            shorter *= scale;
        }
        const Float level = std::max(Float(0), Float(last) + std::log2(shorter));
        if (level >= Float(last) + 1) return At(last, {0, 0});
        const int whole = int(level);
        return Lerp(level - Float(whole), EwaLevel(whole, st, major, minor), EwaLevel(whole + 1, st, major, minor));
    }

    Texel<N> EwaLevel(int i, Point2 st, Vector2 major, Vector2 minor) const {
        if (i >= int(view_.levels.size())) return At(i - 1, {0, 0});
        const MipMap::LevelView &level = view_.levels[i];
        const Vector2 size(Float(level.width), Float(level.height));
        const Point2 center = st * size - Float(0.5);
        major *= size;
        minor *= size;
        // Inside: a x^2 + b x y + c y^2 < 1. The added 1 is the variance of the reconstruction filter.
        Float a = Sqr(major.y) + Sqr(minor.y) + 1;
        Float b = -2 * (major.x * major.y + minor.x * minor.y);
        Float c = Sqr(major.x) + Sqr(minor.x) + 1;
        const Float f = a * c - Sqr(b) / 4;
        // Half extents of the ellipse, from a and c before division by the determinant f.
        const Vector2 extent(std::sqrt(c), std::sqrt(a));
        a /= f;
        b /= f;
        c /= f;
        const Point2i low(ToPixel(std::ceil(center.x - extent.x)), ToPixel(std::ceil(center.y - extent.y)));
        const Point2i high(ToPixel(std::floor(center.x + extent.x)), ToPixel(std::floor(center.y + extent.y)));
        // Repeat is the common case, read without a call.
        const bool repeats = view_.wrap == WrapMode::Repeat;
        const Point2i mask(level.width - 1, level.height - 1);
        Texel<N> sum(0);
        Float weights = 0;
        for (int y = low.y; y <= high.y; ++y) {
            const Float dy = Float(y) - center.y;
            for (int x = low.x; x <= high.x; ++x) {
                const Float dx = Float(x) - center.x;
                const Float r2 = (a * dx + b * dy) * dx + c * dy * dy;
                if (!(r2 < 1)) continue;
                const int index = std::clamp(int(r2 * GaussianEntries), 0, GaussianEntries - 1);
                const Float weight = GaussianTable[index];
                sum += weight * (repeats ? Load(level, x & mask.x, y & mask.y) : At(level, {x, y}));
                weights += weight;
            }
        }
        if (!(weights > 0)) return Bilinear(i, st);
        return sum / weights;
    }

    const MipMap::View &view_;
    size_t first_;
    /// Last used tile, which holds most texels of a lookup.
    [[no_unique_address]] mutable std::conditional_t<Tiled, TileCache::Stored::Tile, std::monostate> tile_;
};

template <int N, bool Tiled>
Texel<N> ReadFrom(const MipMap::View &view, size_t first, Point2 st, Vector2 dst0, Vector2 dst1) {
    switch (view.format) {
        case PixelFormat::U8: return Reader<uint8_t, N, Tiled>(view, first).Filter(st, dst0, dst1);
        case PixelFormat::Half: return Reader<uint16_t, N, Tiled>(view, first).Filter(st, dst0, dst1);
        case PixelFormat::Float: return Reader<float, N, Tiled>(view, first).Filter(st, dst0, dst1);
    }
    return Texel<N>(0);
}

template <int N>
Texel<N> Read(const MipMap::View &view, size_t first, Point2 st, Vector2 dst0, Vector2 dst1) {
    if (view.tiles) return ReadFrom<N, true>(view, first, st, dst0, dst1);
    return ReadFrom<N, false>(view, first, st, dst0, dst1);
}

/// Bytes; smaller levels stay in memory.
constexpr size_t kMinStoredBytes = 1 << 16;

Image KeepColor(Image image) {
    if (image.ChannelCount() == 1) return image;
    if (!image.HasRgb()) throw UserError("The image has several channels but not R, G and B.");
    const int alpha = image.FindChannel("A");
    bool opaque = true;
    if (alpha >= 0)
        for (int y = 0; y < image.Resolution().y && opaque; ++y)
            for (int x = 0; x < image.Resolution().x && opaque; ++x) opaque = image.Get({x, y}, alpha) == 1;
    return image.Extract(opaque ? std::vector<std::string>{"R", "G", "B"}
                                : std::vector<std::string>{"R", "G", "B", "A"});
}

}  // namespace

MipMap::MipMap(Image image, const ColorSpace *colorSpace, TextureFilter filter, WrapMode wrap, Float maxAnisotropy,
               TileCache *tiles)
    : colorSpace_(colorSpace ? colorSpace : &ColorSpace::SRGB()) {
    auto pixels = std::make_shared<Pixels>();
    pixels->levels = BuildPyramid(KeepColor(std::move(image)), wrap);
    const Image &base = pixels->levels[0];
    view_.format = base.Format();
    view_.channels = base.ChannelCount();
    view_.decode = base.Format() == PixelFormat::U8 ? ByteCode::Of(base.Encoding()).DecodeTable() : nullptr;
    view_.filter = filter;
    view_.wrap = wrap;
    view_.maxAnisotropy = maxAnisotropy;
    for (const Image &level : pixels->levels)
        view_.levels.push_back({level.Data(), level.Resolution().x, level.Resolution().y});
    size_t big = 0;
    while (tiles && big < pixels->levels.size() && pixels->levels[big].Bytes() > kMinStoredBytes) ++big;
    if (big > 0) {
        std::vector<Image> stored;
        for (size_t i = 0; i < big; ++i) {
            stored.push_back(std::move(pixels->levels[i]));
            pixels->levels[i] = Image();
            view_.levels[i].texels = nullptr;
        }
        pixels->tiles = tiles->Store(stored);
        view_.tiles = pixels->tiles.get();
    }
    pixels_ = std::move(pixels);
}

MipMap::MipMap(const MipMap &image, TextureFilter filter, Float maxAnisotropy)
    : pixels_(image.pixels_), colorSpace_(image.colorSpace_), view_(image.view_) {
    view_.filter = filter;
    view_.maxAnisotropy = maxAnisotropy;
}

Float MipMap::LookupFloat(Point2 st, Vector2 dst0, Vector2 dst1) const {
    // Only bilinear interpolation mixes channels; EWA falls back to it for footprints of zero width.
    const bool smooth = view_.filter == TextureFilter::Ewa
                            ? !(std::min(glm::length(dst0), glm::length(dst1)) > 0)
                            : view_.filter != TextureFilter::Point && !(Width(dst0, dst1) >= 1);
    if (view_.channels == 1 || !smooth) return Read<1>(view_, 0, st, dst0, dst1).x;
    if (view_.channels == 4) return Read<1>(view_, 3, st, dst0, dst1).x;
    const Texel<3> rgb = Read<3>(view_, 0, st, dst0, dst1);
    return (rgb.x + rgb.y + rgb.z) / 3;
}

Rgb MipMap::LookupRgb(Point2 st, Vector2 dst0, Vector2 dst1) const {
    if (view_.channels == 1) return Rgb(Read<1>(view_, 0, st, dst0, dst1).x);
    return Read<3>(view_, 0, st, dst0, dst1);
}

}  // namespace pbrt
