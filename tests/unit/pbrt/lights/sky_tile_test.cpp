#include "pbrt/lights/sky_tile.h"

#include <gtest/gtest.h>

#include "light_test_support.h"
#include "pbrt/lights/light_table.h"
#include "test_skies.h"
#include "unit/pbrt/bxdfs/sphere_histogram.h"

namespace pbrt::test {
namespace {

TEST(SkyTile, NumbersAndPlacesBelongTogether) {
    EXPECT_EQ(SkyTile::FirstOf(0), 0u);
    EXPECT_EQ(SkyTile::FirstOf(1), 1u);
    EXPECT_EQ(SkyTile::FirstOf(2), 5u);
    EXPECT_EQ(SkyTile::kCount, SkyTile::FirstOf(SkyTile::kMaxLevel + 1));
    for (uint32_t n = 0; n < SkyTile::kCount; n = n < 2000 ? n + 1 : n + 97) {
        const SkyTile tile = SkyTile::Of(n);
        ASSERT_EQ(tile.Number(), n);
        ASSERT_EQ(SkyTile::LevelOf(n), tile.level);
        ASSERT_GE(n, SkyTile::FirstOf(tile.level));
        ASSERT_LT(n, SkyTile::FirstOf(tile.level + 1));
        const Bounds2 square = tile.Square();
        ASSERT_EQ(SkyTile::At(tile.level, (square.low + square.high) * Float(0.5)).Number(), n);
    }
}

TEST(SkyTile, ChildrenFillTheirParent) {
    for (uint32_t n : {0u, 3u, 17u, 1000u, 20000u}) {
        const Bounds2 whole = SkyTile::Of(n).Square();
        double area = 0;
        for (uint32_t c = 1; c <= 4; ++c) {
            const Bounds2 part = SkyTile::Of(4 * n + c).Square();
            EXPECT_GE(part.low.x, whole.low.x);
            EXPECT_GE(part.low.y, whole.low.y);
            EXPECT_LE(part.high.x, whole.high.x);
            EXPECT_LE(part.high.y, whole.high.y);
            area += static_cast<double>((part.high.x - part.low.x) * (part.high.y - part.low.y));
        }
        EXPECT_DOUBLE_EQ(area, static_cast<double>((whole.high.x - whole.low.x) * (whole.high.y - whole.low.y)));
    }
}

TEST(SkyTile, TheSidesOfTheSquareBelongToTiles) {
    for (Point2 st : {Point2(0, 0), Point2(1, 1), Point2(1, 0), Point2(-1e-7f, 1.0000001f)})
        EXPECT_LT(SkyTile::At(5, st).Number(), SkyTile::FirstOf(6));
}

const SampledWavelengths kLambda = SampledWavelengths::SampleVisible(0.3f);

class SkyTiles : public testing::TestWithParam<Sky> {
  protected:
    std::unique_ptr<Light> MakeSky(const Transform &ctm = Transform::Rotate(70, {1, -2, 1})) {
        Params params;
        if (GetParam().color) {
            file_.emplace("tiles.exr", RgbImage(Point2i(GetParam().resolution), GetParam().color));
            params.String("filename", file_->Path());
        }
        auto light = Make("infinite", params, ctm);
        light->Preprocess({0, 0, 0}, 2);
        light->PrepareTiles();
        return light;
    }
    std::optional<TemporaryImage> file_;
};

TEST_P(SkyTiles, DirectionsFollowTheDensity) {
    for (const Transform &ctm : {Transform::Rotate(70, {1, -2, 1}), Transform::Scale({1, -1, 1})}) {
        const auto light = MakeSky(ctm);
        for (uint32_t number : {1u, 7u, 30u, 50u}) {
            auto draw = [&](Rng &rng) -> std::optional<Vector3> {
                auto s = light->SampleLi(At({0, 0, 0}), rng.Uniform2(), kLambda, true, number);
                if (!s) return {};
                return s->wi;
            };
            auto density = [&](const Vector3 &w) { return light->PdfLi(At({0, 0, 0}), w, {}, {}, true, number); };
            Rng rng(3);
            if (!draw(rng)) continue;  // a black tile
            double mass;
            const double p = DirectionTest(draw, density, 20000, 24, &mass);
            EXPECT_NEAR(mass, 1, 0.03) << number;
            EXPECT_GT(p, SidakAlpha(1e-4, 8 * std::size(kSkies))) << number;
        }
    }
}

TEST_P(SkyTiles, SamplesComeWithTheDensityAndTheRadianceOfTheWhole) {
    const auto light = MakeSky();
    Rng rng(5);
    size_t found = 0;
    for (uint32_t number = 1; number < 1000; number += 3) {
        const auto s = light->SampleLi(At({0, 0, 0}), rng.Uniform2(), kLambda, true, number);
        if (!s) continue;
        ++found;
        EXPECT_NEAR(Length(s->wi), 1, 1e-4);
        const Point2 st = light->SquareTowards(s->wi);
        const Bounds2 square = SkyTile::Of(number).Square();
        EXPECT_GT(st.x, square.low.x - 1e-4f);
        EXPECT_LT(st.x, square.high.x + 1e-4f);
        EXPECT_GT(st.y, square.low.y - 1e-4f);
        EXPECT_LT(st.y, square.high.y + 1e-4f);
        const Vector3 back = light->DirectionAt(st);
        EXPECT_GT(Dot(back, s->wi), 0.9999f);
    }
    EXPECT_GT(found, 100u);
}

TEST_P(SkyTiles, TilesOfALevelAddUpToTheSky) {
    const auto light = MakeSky();
    // L / pdf is the integral of the radiance over a tile, but for the colour.
    auto integral = [&](uint32_t number) {
        Rng rng(number);
        double sum = 0;
        for (int i = 0; i < 64; ++i)
            if (auto s = light->SampleLi(At({0, 0, 0}), rng.Uniform2(), kLambda, true, number))
                sum += static_cast<double>(s->L.Average() / s->pdf) / 64;
        return sum;
    };
    double fine = 0, coarse = 0;
    for (uint32_t n = SkyTile::FirstOf(3); n < SkyTile::FirstOf(4); ++n) fine += integral(n);
    for (uint32_t n = SkyTile::FirstOf(1); n < SkyTile::FirstOf(2); ++n) coarse += integral(n);
    const double whole = light->Phi(kLambda, 0).Average() / (std::numbers::pi * 4);
    EXPECT_NEAR(fine / whole, 1, 0.03);
    EXPECT_NEAR(coarse / whole, 1, 0.1);
}

INSTANTIATE_TEST_SUITE_P(Lights, SkyTiles, testing::ValuesIn(kSkies),
                         [](const auto &c) { return std::string(c.param.name); });

TEST(LightTable, TilesHaveIdsBehindThoseOfAllLights) {
    LightTable table;
    table.Add(Make("point", Params()));
    const LightId first = table.Add(Make("infinite", Params()));
    table.Add(Make("distant", Params()));
    const LightId second = table.Add(Make("infinite", Params().Number("scale", 2)));
    table.Finish({0, 0, 0}, 5);
    ASSERT_EQ(table.Skies().size(), 2u);
    EXPECT_EQ(table.Skies()[1], second);
    const LightId tile = table.TileId(1, 20);
    EXPECT_GE(tile.value, table.Size());
    EXPECT_TRUE(table.IsTile(tile));
    EXPECT_FALSE(table.IsTile(second));
    EXPECT_EQ(table.SkyOf(tile), second);
    EXPECT_EQ(table.NumberOf(tile), 20u);
    EXPECT_EQ(table.SkyIndexOf(table.TileId(0, SkyTile::kCount - 1)), 0u);
    EXPECT_EQ(table.SkyOf(table.TileId(0, SkyTile::kCount - 1)), first);
    EXPECT_EQ(&table[tile].Whole(), &table[second].Whole());
    EXPECT_EQ(table[tile].Kind(), LightKind::Infinite);
    EXPECT_EQ(table.Parts().GroupOf(tile), second.value);
    EXPECT_EQ(table.Wholes().GroupOf(tile), table.WholeOf(second));
    ASSERT_TRUE(table[tile].SampleLi(At({0, 0, 0}), {0.5f, 0.5f}, kLambda, true));
}

}  // namespace
}  // namespace pbrt::test
