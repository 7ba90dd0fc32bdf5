#include "ext/lab/pictures.h"

#include <gtest/gtest.h>
#include <cmath>

#include "pbrt/core/files.h"
#include "support/folder_test.h"

namespace ext::lab {

namespace {

/// A picture of grey values, each with its share of the pixels.
Image Grey(const std::vector<std::pair<double, Float>> &shares) {
    Image image(PixelFormat::Float, {100, 10}, {"R", "G", "B"});
    int x = 0;
    for (const auto &[share, value] : shares)
        for (int end = x + int(std::lround(100 * share)); x < end; ++x)
            for (int y = 0; y < 10; ++y)
                for (int c = 0; c < 3; ++c) image.Set({x, y}, c, value);
    return image;
}

}  // namespace

TEST(ChooseExposure, FitsTheRoomAndNotItsBrightWindow) {
    // A window covers a fifth of the picture and is a thousand times as bright.
    EXPECT_NEAR(ChooseExposure(Grey({{0.3, 0.02f}, {0.5, 0.05f}, {0.2, 50}})), 0.18 / 0.05, 1e-5);
    // Black pixels around the room do not count.
    EXPECT_NEAR(ChooseExposure(Grey({{0.7, 0}, {0.1, 0.02f}, {0.15, 0.05f}, {0.05, 50}})), 0.18 / 0.05, 1e-5);
}

TEST(ChooseExposure, LitPartOfADarkPictureIsNotBlownOut) {
    EXPECT_NEAR(ChooseExposure(Grey({{0.6, 0.0001f}, {0.4, 0.5f}})), 0.9 / 0.5, 1e-5);
}

TEST(ChooseExposure, PictureWithoutHighlightsIsAsBrightAsItCanBe) {
    EXPECT_NEAR(ChooseExposure(Grey({{0.5, 0.3f}, {0.5, 0.4f}})), 0.9 / 0.4, 1e-5);
    EXPECT_EQ(ChooseExposure(Grey({{1, 0}})), 1);
}

class RangePicture : public pbrt::test::FolderTest {};

TEST_F(RangePicture, KeepsEveryBrightness) {
    Image image(PixelFormat::Float, {5, 2}, {"R", "G", "B"});
    const Float values[] = {1e-9f, 0.0123f, 0.5f, 1,  255.9f,
                            65504, 3e30f,   0,    -1, std::numeric_limits<Float>::infinity()};
    for (int i = 0; i < 10; ++i) {
        image.Set({i % 5, i / 5}, 0, values[i]);
        image.Set({i % 5, i / 5}, 1, values[i] / 2);
        image.Set({i % 5, i / 5}, 2, 0);
    }
    WriteRangeImage(Path("range.hdr"), image);
    const std::string text = ReadFileContents(Path("range.hdr"));
    const std::string size = "\n\n-Y 2 +X 5\n";
    const size_t at = text.find(size);
    ASSERT_NE(at, std::string::npos);
    EXPECT_EQ(text.rfind("#?RADIANCE\n", 0), 0u);
    ASSERT_EQ(text.size(), at + size.size() + 10 * 4);
    for (int i = 0; i < 10; ++i) {
        const char *pixel = text.data() + at + size.size() + 4 * i;
        const int exponent = uint8_t(pixel[3]);
        for (int c = 0; c < 3; ++c) {
            const double stored =
                image.Get({i % 5, i / 5}, c) > 0 && std::isfinite(values[i]) ? double(image.Get({i % 5, i / 5}, c)) : 0;
            const double shown = exponent ? (uint8_t(pixel[c]) + 0.5) * std::ldexp(1.0, exponent - 136) : 0;
            // The tolerance is half a step of the brightest colour of the pixel.
            const double step = exponent ? std::ldexp(1.0, exponent - 136) : 0;
            EXPECT_NEAR(shown, stored, 0.5001 * step) << i << " " << c;
        }
        const double value = double(values[i]);
        if (value > 0 && std::isfinite(value)) {
            EXPECT_LE(std::ldexp(1.0, exponent - 136), value / 128 * 1.0001);
        }
    }
}

}  // namespace ext::lab
