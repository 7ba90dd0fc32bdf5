#include "pbrt/images/false_color.h"

#include "image_fixtures.h"

namespace pbrt::test {
namespace {

Rgb Shown(const Image &image, int x, int y) {
    const ColorEncoding encoding{};
    Rgb c;
    for (int i = 0; i < 3; ++i) c[i] = Encoded(encoding, image.Get({x, y}, i));
    return c;
}

void ExpectColor(const Image &image, int x, int y, const Rgb &color) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(Shown(image, x, y)[c], color[c], 1e-3f);
}

TEST(FalseColor, RampGetsBrighterAndEndsWhereTheScaleEnds) {
    Float before = -1;
    for (int i = 0; i <= 20; ++i) {
        Rgb c = false_color::Ramp(Float(i) / 20);
        Float luminance = Dot(c, Rgb(0.2126f, 0.7152f, 0.0722f));
        EXPECT_GT(luminance, before);
        before = luminance;
    }
    FalseColorStyle style;
    style.min = 2;
    style.max = 4;
    Image shown = FalseColor(Row({1, 2, 3, 4, 9}), 0, style);
    EXPECT_EQ(Shown(shown, 0, 0), Shown(shown, 1, 0));
    EXPECT_EQ(Shown(shown, 3, 0), Shown(shown, 4, 0));
    ExpectColor(shown, 2, 0, false_color::Ramp(0.5f));
}

TEST(FalseColor, IdsHaveColoursOfTheirOwn) {
    // Nearly all pairs of the first ids must differ visibly; there is not room in the colours for all.
    int alike = 0, pairs = 0;
    for (uint64_t a = 0; a < 60; ++a)
        for (uint64_t b = 0; b < a; ++b) {
            Rgb d = glm::abs(false_color::OfId(a) - false_color::OfId(b));
            alike += d.x + d.y + d.z < 0.1f;
            ++pairs;
        }
    EXPECT_LT(alike, pairs / 25);
    for (uint64_t id = 0; id < 500; ++id) {
        const Rgb c = false_color::OfId(id);
        const auto [least, most] = std::minmax({c.x, c.y, c.z});
        EXPECT_GT(most, 0.5f);
        EXPECT_LE(most, 1);
        EXPECT_GE(least, 0);
        EXPECT_GT(most - least, 0.2f) << "the colour is nearly grey";
    }
}

TEST(FalseColor, WhatIsMaskedOrNotFiniteIsMarked) {
    Image mask = Row({1, 0, 1});
    Image shown = FalseColor(Row({Infinity, Infinity, 0.5f}), 0, FalseColorStyle(), &mask);
    ExpectColor(shown, 0, 0, false_color::Invalid);
    ExpectColor(shown, 1, 0, Rgb(0.13f));
}

TEST(FalseColor, LegendRunsThroughTheScale) {
    FalseColorStyle style;
    style.legendRows = 4;
    Image shown = FalseColor(Row({0, 0, 0, 0, 0, 0, 0, 0, 0, 0}), 0, style);
    ASSERT_EQ(shown.Resolution(), Point2i(10, 5));
    for (int x = 0; x < 10; ++x) ExpectColor(shown, x, 4, false_color::Ramp((Float(x) + 0.5f) / 10));
    style.scale = FalseColorStyle::Scale::Id;
    EXPECT_EQ(FalseColor(Row({1, 2}), 0, style).Resolution().y, 1);
}

}  // namespace
}  // namespace pbrt::test
