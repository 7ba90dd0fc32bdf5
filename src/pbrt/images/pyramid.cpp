#include <array>
#include <bit>
#include <cmath>

#include "pbrt/core/error.h"
#include "pbrt/core/parallel.h"
#include "pbrt/images/mipmap.h"

namespace pbrt {

namespace {

int NextPowerOfTwo(int n) { return static_cast<int>(std::bit_ceil(static_cast<unsigned>(n))); }

/// Source pixels per target pixel and axis.
constexpr int Taps = 4;

struct PixelTaps {
    int first = 0;
    std::array<Float, Taps> weight{};
};

Float Sinc(Float x) { return std::abs(x) < Float(1e-5) ? 1 : std::sin(Pi * x) / (Pi * x); }

// Lanczos filter of radius 2 source pixels at every target pixel centre; weights add up to 1.
std::vector<PixelTaps> ResamplingTaps(int from, int to) {
    constexpr Float radius = 2;
    std::vector<PixelTaps> taps(static_cast<size_t>(to));
    for (int i = 0; i < to; ++i) {
        PixelTaps &tap = taps[static_cast<size_t>(i)];
        Float center = (static_cast<Float>(i) + Float(0.5)) * static_cast<Float>(from) / static_cast<Float>(to);
        tap.first = static_cast<int>(std::floor(center - radius + Float(0.5)));
        Float sum = 0;
        for (int j = 0; j < Taps; ++j) {
            Float x = static_cast<Float>(tap.first + j) + Float(0.5) - center;
            Float w = std::abs(x) > radius ? 0 : Sinc(x) * Sinc(x / radius);
            tap.weight[static_cast<size_t>(j)] = w;
            sum += w;
        }
        for (Float &w : tap.weight) w /= sum;
    }
    return taps;
}

// Enlarges to powers of two, as float. Pixels beyond the edges follow the wrap mode; overshoot below 0 is cut off.
Image Enlarge(const Image &image, Point2i target, WrapMode wrap) {
    // Every tap reaches at most `border` pixels beyond the image.
    constexpr int border = Taps / 2;
    const Point2i size = image.Resolution();
    const int channels = image.ChannelCount();
    const auto stretchX = ResamplingTaps(size.x, target.x), stretchY = ResamplingTaps(size.y, target.y);

    // Rows -border ... size.y + border - 1, stretched in x only.
    Image wide(PixelFormat::Float, {target.x, size.y + 2 * border}, image.Channels());
    ParallelFor(wide.Resolution().y, 16, [&](int64_t begin, int64_t end) {
        for (int row = static_cast<int>(begin); row < static_cast<int>(end); ++row)
            for (int x = 0; x < target.x; ++x) {
                const PixelTaps &tap = stretchX[static_cast<size_t>(x)];
                for (int c = 0; c < channels; ++c) {
                    Float v = 0;
                    for (int j = 0; j < Taps; ++j)
                        v += tap.weight[static_cast<size_t>(j)] * image.Get({tap.first + j, row - border}, c, wrap);
                    wide.Set({x, row}, c, v);
                }
            }
    });
    Image result(PixelFormat::Float, target, image.Channels());
    ParallelFor(target.y, 16, [&](int64_t begin, int64_t end) {
        for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
            const PixelTaps &tap = stretchY[static_cast<size_t>(y)];
            for (int x = 0; x < target.x; ++x)
                for (int c = 0; c < channels; ++c) {
                    Float v = 0;
                    for (int j = 0; j < Taps; ++j)
                        v += tap.weight[static_cast<size_t>(j)] * wide.Get({x, tap.first + j + border}, c);
                    result.Set({x, y}, c, std::max(v, Float(0)));
                }
        }
    });
    return result;
}

// Means of 2x2 pixels (2x1 or 1x2 once one side is down to one pixel).
Image Halve(const Image &image) {
    const Point2i size = image.Resolution();
    const Point2i step(size.x > 1 ? 1 : 0, size.y > 1 ? 1 : 0);
    Image result(PixelFormat::Float, glm::max(size / 2, Point2i(1)), image.Channels());
    ParallelFor(result.Resolution().y, 16, [&](int64_t begin, int64_t end) {
        for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
            for (int x = 0; x < result.Resolution().x; ++x) {
                const Point2i p = Point2i(x, y) * (step + 1), q = p + step;
                for (int c = 0; c < image.ChannelCount(); ++c)
                    result.Set(
                        {x, y}, c,
                        (image.Get(p, c) + image.Get({q.x, p.y}, c) + image.Get({p.x, q.y}, c) + image.Get(q, c)) / 4);
            }
    });
    return result;
}

// As ConvertTo, but with the encoding of the original.
Image Store(const Image &level, const Image &like) {
    if (like.Format() == PixelFormat::Float) return level;
    Image result(like.Format(), level.Resolution(), like.Channels(), like.Encoding());
    ParallelFor(level.Resolution().y, 16, [&](int64_t begin, int64_t end) {
        for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
            for (int x = 0; x < level.Resolution().x; ++x)
                for (int c = 0; c < level.ChannelCount(); ++c) result.Set({x, y}, c, level.Get({x, y}, c));
    });
    return result;
}

}  // namespace

std::vector<Image> BuildPyramid(Image image, WrapMode wrap) {
    PBRT_CHECK(image);
    const Point2i target(NextPowerOfTwo(image.Resolution().x), NextPowerOfTwo(image.Resolution().y));
    std::vector<Image> levels;
    // The unrounded level that the next one is made from.
    Image exact;
    if (target == image.Resolution()) {
        exact = image.ConvertTo(PixelFormat::Float);
        levels.push_back(std::move(image));
    } else {
        exact = Enlarge(image, target, wrap);
        levels.push_back(Store(exact, image));
    }
    while (exact.Resolution() != Point2i(1)) {
        exact = Halve(exact);
        levels.push_back(Store(exact, levels[0]));
    }
    return levels;
}

}  // namespace pbrt
