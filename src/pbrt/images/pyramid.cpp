#include <array>
#include <bit>
#include <cmath>

#include "pbrt/core/error.h"
#include "pbrt/core/parallel.h"
#include "pbrt/images/mipmap.h"

namespace pbrt {
namespace {

/// Source pixels per target pixel and axis; the loops below are unrolled for four.
constexpr int Taps = 4;

struct PixelTaps {
    int first = 0;
    std::array<Float, Taps> weight{};
};

Float Sinc(Float x) { return std::abs(x) < Float(1e-5) ? 1 : std::sin(Pi * x) / (Pi * x); }

// Lanczos filter of radius 2 source pixels at target pixel centres; weights sum to 1.
std::vector<PixelTaps> ResamplingTaps(int from, int to) {
    constexpr Float radius = 2;
    std::vector<PixelTaps> taps(to);
    for (int i = 0; i < to; ++i) {
        PixelTaps &tap = taps[i];
        Float center = (Float(i) + Float(0.5)) * Float(from) / Float(to);
        tap.first = int(std::floor(center - radius + Float(0.5)));
        Float sum = 0;
        for (int j = 0; j < Taps; ++j) {
            Float x = Float(tap.first + j) + Float(0.5) - center;
            Float w = std::abs(x) > radius ? 0 : Sinc(x) * Sinc(x / radius);
            tap.weight[j] = w;
            sum += w;
        }
        for (Float &w : tap.weight) w /= sum;
    }
    return taps;
}

// Upsamples to `target` as float. The wrap mode applies beyond edges; negative overshoot is clipped.
Image Enlarge(const Image &image, Point2i target, WrapMode wrap) {
    // Largest reach of the taps beyond the image.
    constexpr int border = Taps / 2;
    const Point2i size = image.Resolution();
    const int channels = image.ChannelCount();
    const auto stretchX = ResamplingTaps(size.x, target.x), stretchY = ResamplingTaps(size.y, target.y);
    const size_t width = size_t(target.x) * channels;

    // Rows -border ... size.y + border - 1, resampled in x only.
    const int rows = size.y + 2 * border;
    std::vector<float> wide(width * rows);
    ParallelFor(rows, 16, [&](int64_t begin, int64_t end) {
        std::vector<float> source(size_t(size.x + 2 * border) * channels);
        for (int64_t row = begin; row < end; ++row) {
            float *fill = source.data();
            for (int x = -border; x < size.x + border; ++x)
                for (int c = 0; c < channels; ++c) *fill++ = image.Get({x, int(row) - border}, c, wrap);
            float *out = wide.data() + row * width;
            for (const PixelTaps &taps : stretchX) {
                const float *in = source.data() + (taps.first + border) * channels;
                for (int c = 0; c < channels; ++c, ++in)
                    *out++ = taps.weight[0] * in[0] + taps.weight[1] * in[channels] +
                             taps.weight[2] * in[2 * channels] + taps.weight[3] * in[3 * channels];
            }
        }
    });
    Image result(PixelFormat::Float, target, image.Channels());
    ParallelForEach(target.y, 16, [&](int64_t y) {
        const PixelTaps &taps = stretchY[y];
        const float *in = wide.data() + (taps.first + border) * width;
        float *out = static_cast<float *>(result.Data()) + y * width;
        for (size_t i = 0; i < width; ++i)
            out[i] = std::max(0.f, taps.weight[0] * in[i] + taps.weight[1] * in[i + width] +
                                       taps.weight[2] * in[i + 2 * width] + taps.weight[3] * in[i + 3 * width]);
    });
    return result;
}

// Box filter of 2x2 pixels (2x1 or 1x2 once one side is 1) of a float image.
Image Halve(const Image &image) {
    const Point2i size = image.Resolution();
    const size_t channels = image.ChannelCount();
    const size_t width = size.x * channels;
    const size_t right = size.x > 1 ? channels : 0, below = size.y > 1 ? width : 0;
    Image result(PixelFormat::Float, glm::max(size / 2, Point2i(1)), image.Channels());
    const Point2i resultSize = result.Resolution();
    ParallelForEach(resultSize.y, 16, [&](int64_t y) {
        const float *in = static_cast<const float *>(image.Data()) + 2 * y * width;
        float *out = static_cast<float *>(result.Data()) + y * resultSize.x * channels;
        for (int x = 0; x < resultSize.x; ++x, in += channels)
            for (size_t c = 0; c < channels; ++c, ++in)
                *out++ = (in[0] + in[right] + in[below] + in[below + right]) / 4;
    });
    return result;
}

Image Store(const Image &level, const Image &like) {
    if (like.Format() == PixelFormat::Float) return level;
    Image result(like.Format(), level.Resolution(), like.Channels(), like.Encoding());
    ParallelForEach(level.Resolution().y, 16, [&](int64_t y) {
        for (Point2i p(0, int(y)); p.x < level.Resolution().x; ++p.x)
            for (int c = 0; c < level.ChannelCount(); ++c) result.Set(p, c, level.Get(p, c));
    });
    return result;
}

}  // namespace

std::vector<Image> BuildPyramid(Image image, WrapMode wrap) {
    PBRT_CHECK(image);
    const Point2i size = image.Resolution();
    const Point2i target(std::bit_ceil(unsigned(size.x)), std::bit_ceil(unsigned(size.y)));
    std::vector<Image> levels;
    // Unrounded source of the next level.
    Image exact;
    if (target == size) {
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
