#pragma once
#include <initializer_list>
#include <string>

#include "pbrt/images/image.h"
#include "support/folder_test.h"

namespace pbrt::test {

inline std::string Bytes(std::initializer_list<int> values) {
    std::string bytes;
    for (int v : values) bytes += char(v);
    return bytes;
}

/// An image of pseudo-random values in [low, high], which all differ.
inline Image NoiseImage(PixelFormat format, Point2i resolution, std::vector<std::string> channels, Float low = 0,
                        Float high = 1, ColorEncoding encoding = {}) {
    Image image(format, resolution, std::move(channels), encoding);
    uint32_t state = 12345;
    for (int y = 0; y < resolution.y; ++y)
        for (int x = 0; x < resolution.x; ++x)
            for (int c = 0; c < image.ChannelCount(); ++c) {
                state = state * 1664525u + 1013904223u;
                image.Set({x, y}, c, low + (high - low) * Float(state >> 8) * 0x1p-24f);
            }
    return image;
}

inline void ExpectSamePixels(const Image &a, const Image &b, Float tolerance = 0) {
    ASSERT_EQ(a.Resolution(), b.Resolution());
    ASSERT_EQ(a.Channels(), b.Channels());
    for (int y = 0; y < a.Resolution().y; ++y)
        for (int x = 0; x < a.Resolution().x; ++x)
            for (int c = 0; c < a.ChannelCount(); ++c)
                ASSERT_NEAR(a.Get({x, y}, c), b.Get({x, y}, c), tolerance)
                    << "x " << x << " y " << y << " channel " << c;
}

}  // namespace pbrt::test
