#include <cmath>

#include "image_fixtures.h"

namespace pbrt::test {

TEST(ColorEncoding, ParsesTheNamesOfTheFormatOnly) {
    EXPECT_EQ(ColorEncoding::Parse("linear")->kind, ColorEncoding::Kind::Linear);
    EXPECT_EQ(ColorEncoding::Parse("sRGB")->kind, ColorEncoding::Kind::SRGB);
    ASSERT_TRUE(ColorEncoding::Parse("gamma 2.2"));
    EXPECT_FLOAT_EQ(ColorEncoding::Parse("gamma 2.2")->gamma, 2.2f);
    for (const char *wrong :
         {"", "srgb", "Linear", "gamma", "gamma ", "gamma x", "gamma 0", "gamma -1", "gamma 2 2", "gamma inf"})
        EXPECT_FALSE(ColorEncoding::Parse(wrong)) << wrong;
}

TEST(ColorEncoding, MatchesKnownSrgbValues) {
    const ColorEncoding sRGB{};
    // In IEC 61966-2-1 the two pieces of the curve meet near 0.04045, and mid grey 0.5 is about 0.214 in linear values.
    EXPECT_FLOAT_EQ(sRGB.ToLinear(0), 0);
    EXPECT_FLOAT_EQ(sRGB.ToLinear(1), 1);
    EXPECT_NEAR(sRGB.ToLinear(0.5f), 0.21404114f, 1e-6f);
    EXPECT_NEAR(sRGB.ToLinear(0.04f), 0.04f / 12.92f, 1e-8f);
    EXPECT_NEAR(Encoded(sRGB, 0.18f), 0.46135613f, 1e-6f);
}

TEST(ByteCode, DecodesLikeToLinearAndIsKept) {
    for (const char *name : {"linear", "sRGB", "gamma 1.8"}) {
        const ColorEncoding encoding = *ColorEncoding::Parse(name);
        const ByteCode &code = ByteCode::Of(encoding);
        for (int i = 0; i < 256; ++i) {
            EXPECT_EQ(code.Decode(uint8_t(i)), encoding.ToLinear(Float(i) / 255)) << name << i;
            EXPECT_EQ(code.DecodeTable()[i], code.Decode(uint8_t(i)));
        }
        EXPECT_EQ(&code, &ByteCode::Of(encoding));
    }
}

TEST(ByteCode, EncodesToTheNearestEncodedByte) {
    for (const char *name : {"linear", "sRGB", "gamma 1.8", "gamma 0.5", "gamma 6"}) {
        const ColorEncoding encoding = *ColorEncoding::Parse(name);
        const ByteCode &code = ByteCode::Of(encoding);
        for (int i = -1000; i < 31000; ++i) {
            const Float v = Float(i) / 30000;
            const Float exact = 255 * Encoded(encoding, std::clamp(v, Float(0), Float(1)));
            // At most 0.5, up to the rounding of the power functions.
            ASSERT_NEAR(code.Encode(v), exact, 0.5002f) << name << " " << v;
        }
        EXPECT_EQ(code.Encode(NAN), 0);
        EXPECT_EQ(code.Encode(INFINITY), 255);
        EXPECT_EQ(code.Encode(-INFINITY), 0);
    }
}

TEST(ColorEncoding, DecodingAndEncodingReturnEveryByte) {
    for (const char *name : {"linear", "sRGB", "gamma 1.8", "gamma 0.5"}) {
        Image image(PixelFormat::U8, {256, 1}, {"Y"}, *ColorEncoding::Parse(name));
        auto *bytes = static_cast<uint8_t *>(image.Data());
        for (int i = 0; i < 256; ++i) bytes[i] = uint8_t(i);
        Image copy = image;
        for (int i = 0; i < 256; ++i) copy.Set({i, 0}, 0, image.Get({i, 0}, 0));
        for (int i = 0; i < 256; ++i) EXPECT_EQ(static_cast<const uint8_t *>(copy.Data())[i], i) << name;
    }
}

TEST(Image, StoresWhatItsFormatHolds) {
    Image bytes(PixelFormat::U8, {2, 2}, {"Y"}), half(PixelFormat::Half, {2, 2}, {"Y"}),
        real(PixelFormat::Float, {2, 2}, {"Y"});
    for (Image *image : {&bytes, &half, &real}) {
        image->Set({1, 1}, 0, 0.5f);
        EXPECT_NEAR(image->Get({1, 1}, 0), 0.5f, 0.005f);
        EXPECT_EQ(image->Get({0, 1}, 0), 0);
    }
    const auto stored = [](Image &image, Float value) {
        image.Set({0, 0}, 0, value);
        return image.Get({0, 0}, 0);
    };
    EXPECT_EQ(stored(bytes, 7), 1);
    EXPECT_EQ(stored(bytes, -1), 0);
    EXPECT_EQ(stored(bytes, NAN), 0);
    EXPECT_EQ(stored(half, 1e9f), 65504);
    EXPECT_TRUE(std::isnan(stored(half, NAN)));
    EXPECT_EQ(stored(real, 1e9f), 1e9f);
    EXPECT_EQ(bytes.Bytes(), 4u);
    EXPECT_EQ(half.Bytes(), 8u);
    EXPECT_EQ(real.Bytes(), 16u);
}

TEST(Image, SelectReordersAndNamesMissingChannels) {
    const Image image = NoiseImage(PixelFormat::U8, {5, 3}, kRgba);
    const Image selected = image.Select({"A", "G"});
    EXPECT_EQ(selected.Format(), PixelFormat::Float);
    EXPECT_EQ(image.Extract({"A", "G"}).Format(), PixelFormat::U8);
    ForEachPixel(image, [&](Point2i p) {
        EXPECT_EQ(selected.Get(p, 0), image.Get(p, 3));
        EXPECT_EQ(selected.Get(p, 1), image.Get(p, 1));
    });
    ExpectError([&] { image.Select({"Z"}); }, {"\"Z\"", "A"});
}

TEST(Image, CropKeepsThePixelsInside) {
    for (PixelFormat format : kFormats) {
        const Image image = NoiseImage(format, {7, 6}, kRgb);
        const Image crop = image.Crop({{2, 1}, {6, 4}});
        ASSERT_EQ(crop.Resolution(), Point2i(4, 3));
        ForEachValue(crop, [&](Point2i p, int c) { EXPECT_EQ(crop.Get(p, c), image.Get(p + Point2i(2, 1), c)); });
    }
}

TEST(WrapMode, RepeatShiftsByWholeImages) {
    const Point2i resolution(5, 3);
    for (int y = -20; y < 20; ++y)
        for (int x = -20; x < 20; ++x) {
            Point2i p(x, y);
            ASSERT_TRUE(RemapPixel(p, resolution, WrapMode::Repeat));
            EXPECT_TRUE(p.x >= 0 && p.x < 5 && p.y >= 0 && p.y < 3);
            EXPECT_EQ((x - p.x) % 5, 0);
            EXPECT_EQ((y - p.y) % 3, 0);
        }
}

TEST(WrapMode, ClampTakesTheNearestPixelAndBlackNone) {
    for (Point2i p : {Point2i(-3, 1), Point2i(9, 9), Point2i(2, -1), Point2i(1, 1)}) {
        Point2i clamped = p, black = p;
        EXPECT_TRUE(RemapPixel(clamped, {5, 3}, WrapMode::Clamp));
        EXPECT_EQ(clamped, Point2i(std::min(std::max(p.x, 0), 4), std::min(std::max(p.y, 0), 2)));
        EXPECT_EQ(RemapPixel(black, {5, 3}, WrapMode::Black), p == Point2i(1, 1));
    }
}

TEST(WrapMode, OctahedralEdgesMeetTheirMirrorImages) {
    const Point2i resolution(8, 8);
    auto mapped = [&](Point2i p) {
        EXPECT_TRUE(RemapPixel(p, resolution, WrapMode::OctahedralSphere));
        return p;
    };
    // A step over an edge at distance d from a corner leads back into the square at distance d from the other corner of
    // that edge.
    for (int i = 0; i < 8; ++i) {
        EXPECT_EQ(mapped({8, i}), Point2i(7, 7 - i));
        EXPECT_EQ(mapped({i, 8}), Point2i(7 - i, 7));
        EXPECT_EQ(mapped({10, i}), Point2i(5, 7 - i));
        EXPECT_EQ(mapped({-1, i}), Point2i(1, 7 - i));
        EXPECT_EQ(mapped({i, -2}), Point2i(7 - i, 2));
    }
    // Every coordinate, however far outside, is mapped into the square.
    for (int v : {-2000000000, -1000, -17, -16, -9, -8, 16, 17, 23, 1000, 2000000000})
        for (int w : {-2000000000, -8, 3, 8, 2000000000}) {
            Point2i p = mapped({v, w});
            EXPECT_TRUE(p.x >= 0 && p.y >= 0 && p.x < 8 && p.y < 8) << v << " " << w;
        }
    Point2i single(-1, 2);
    EXPECT_TRUE(RemapPixel(single, {1, 1}, WrapMode::OctahedralSphere));
    EXPECT_EQ(single, Point2i(0, 0));
}

TEST(Image, BilinearIsTheTentWeightedSum) {
    const Image image = NoiseImage(PixelFormat::Float, {6, 5}, kRgb);
    for (WrapMode wrap : {WrapMode::Repeat, WrapMode::Black, WrapMode::Clamp})
        for (Point2 st : {Point2(0.31f, 0.77f), Point2(0, 0), Point2(1, 1), Point2(-0.4f, 1.3f), Point2(0.5f, 0.02f)}) {
            double expected = 0;
            for (int y = -10; y < 20; ++y)
                for (int x = -10; x < 20; ++x) {
                    double wx = std::max(0.0, 1 - std::abs(double(st.x) * 6 - (x + 0.5)));
                    double wy = std::max(0.0, 1 - std::abs(double(st.y) * 5 - (y + 0.5)));
                    if (wx * wy > 0) expected += wx * wy * double(image.Get({x, y}, 1, wrap));
                }
            EXPECT_NEAR(image.Bilinear(st, 1, wrap), expected, 2e-6);
        }
}

}  // namespace pbrt::test
