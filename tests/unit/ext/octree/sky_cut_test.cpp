#include "ext/octree/sky_cut.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "ext/octree/sky_cells.h"
#include "pbrt/math/rng.h"
#include "pbrt/math/warps.h"
#include "support/build_text.h"

namespace ext {
namespace {

/// A sky of one colour, or the conformance suite's image.
BuiltScene WithSky(bool image) {
    const std::string file = PBRT_SOURCE_DIR "/tests/conformance/suite/scenes/assets/env_sky.exr";
    return test::BuildText("Camera \"perspective\"\nWorldBegin\nLightSource \"infinite\" " +
                           (image ? "\"string filename\" \"" + file + "\"" : std::string("\"rgb L\" [ 1 1 1 ]")) +
                           "\nShape \"sphere\"");
}

/// The cut holds every direction exactly once.
void ExpectWhole(const SkyCut &cut) {
    uint32_t next = 0;
    for (const SkyCut::Tile &t : cut.Tiles()) {
        ASSERT_EQ(SkyTiles::KeyOf(t.number), next);
        next += SkyTiles::KeyCount(t.number);
    }
    EXPECT_EQ(next, 1u << 2 * SkyTile::kMaxLevel);
}

/// Rays from a cell whose visible part of the sky is the set of keys for which `sees` is true. Learns `rounds` times.
template <class Sees>
SkyCut Learn(SkyTiles &sky, Sees &&sees, int rounds, size_t most) {
    SkyCut cut(sky.FirstCut(most), 0.1f);
    Rng rng(1);
    for (int round = 0; round < rounds; ++round) {
        for (size_t i = 0; i < cut.Tiles().size(); ++i) {
            const uint32_t number = cut.Tiles()[i].number;
            for (int k = 0; k < 40; ++k) {
                const uint32_t key =
                    SkyTiles::KeyOf(number) +
                    static_cast<uint32_t>(rng.Uniform() * static_cast<Float>(SkyTiles::KeyCount(number)));
                cut.Add(i, 1, sees(key) ? 1 : 0);
            }
        }
        cut.Estimate(sky, {});
        std::vector<uint32_t> children;
        cut.AppendChildren(sky, &children);
        sky.Know(children);
        cut.Adapt(sky, most);
    }
    return cut;
}

TEST(SkyTiles, GIsPositiveWhereverATileCanContribute) {
    for (bool image : {false, true}) {
        const BuiltScene built = WithSky(image);
        SkyTiles sky(built.scene->Lights(), 0);
        const std::vector<uint32_t> cut = sky.FirstCut(64);
        Rng rng(9);
        for (uint32_t number : cut) {
            const SkyTiles::Tile &tile = sky.At(number);
            const LightPart light = built.scene->Lights()[sky.IdOf(number)];
            for (int i = 0; i < 200; ++i) {
                const auto s = light.SampleLi({}, rng.Uniform2(), SampledWavelengths::SampleVisible(0.5f), true);
                if (!s) continue;
                ASSERT_GT(tile.irradiance, 0);
                // Inside the cone: no receiver for which the direction is above the horizon has G = 0.
                const Float cosine = Dot(s->wi, tile.direction);
                EXPECT_LT(std::sqrt(std::max(1 - cosine * cosine, Float(0))), tile.sine);
                EXPECT_GT(cosine, 0);
            }
        }
    }
}

TEST(SkyTiles, TheFirstCutHoldsEveryDirectionOnce) {
    for (bool image : {false, true}) {
        const BuiltScene built = WithSky(image);
        SkyTiles sky(built.scene->Lights(), 0);
        for (size_t count : {16, 64, 200}) {
            const SkyCut cut(sky.FirstCut(count), 1);
            EXPECT_LE(cut.Tiles().size(), count);
            EXPECT_GT(cut.Tiles().size() + 3, count);
            ExpectWhole(cut);
        }
        Rng rng(2);
        for (int i = 0; i < 1000; ++i) {
            const Vector3 d = SampleUniformSphere(rng.Uniform2());
            const Point2 st = built.scene->Lights()[sky.Sky()].Whole().SquareTowards(d);
            EXPECT_EQ(SkyTile::At(4, st).Number() - SkyTile::FirstOf(4),
                      sky.KeyTowards(d) >> 2 * (SkyTile::kMaxLevel - 4));
        }
    }
}

TEST(SkyCut, FindsAWindow) {
    const BuiltScene built = WithSky(false);
    SkyTiles sky(built.scene->Lights(), 0);
    // A part of the sphere of 1/200 that no coarse tile equals.
    const uint32_t all = 1u << 2 * SkyTile::kMaxLevel, begin = all / 3, end = begin + all / 200;
    auto sees = [&](uint32_t key) { return key >= begin && key < end; };
    const SkyCut cut = Learn(sky, sees, 8, 64);
    ExpectWhole(cut);
    EXPECT_LE(cut.Tiles().size(), 64u);
    double weights = 0, useful = 0;
    for (const SkyCut::Tile &t : cut.Tiles()) {
        const double w = static_cast<double>(sky.At(t.number).irradiance) * std::sqrt(static_cast<double>(t.visible));
        const uint32_t first = SkyTiles::KeyOf(t.number), last = first + SkyTiles::KeyCount(t.number);
        const double inside =
            std::max(0.0, static_cast<double>(std::min(last, end)) - static_cast<double>(std::max(first, begin)));
        weights += w;
        useful += w * inside / static_cast<double>(last - first);
    }
    EXPECT_GT(useful / weights, 0.7) << "rays still go where nothing is seen";
}

TEST(SkyCut, EstimatesAreTheShareOfTheRaysThatLeft) {
    const BuiltScene built = WithSky(false);
    SkyTiles sky(built.scene->Lights(), 0);
    SkyCut cut(sky.FirstCut(16), 0.5f);
    cut.Add(0, 10000, 2500);
    cut.Add(1, 10000, 0);
    cut.Add(2, 10000, 10000);
    cut.Estimate(sky, {});
    EXPECT_NEAR(cut.Tiles()[0].visible, 0.25f, 1e-3f);
    EXPECT_GT(cut.Tiles()[1].visible, 0);
    EXPECT_LT(cut.Tiles()[1].visible, 1e-3f);
    EXPECT_NEAR(cut.Tiles()[2].visible, 1, 1e-3f);
    EXPECT_LE(cut.Tiles()[2].visible, 1);
}

TEST(SkyCut, AFewRaysTellOfTheRegionAround) {
    const BuiltScene built = WithSky(false);
    SkyTiles sky(built.scene->Lights(), 0);
    SkyCut cut(sky.FirstCut(64), 0.5f);
    // The first quarter meets a wall; tile 3 itself has no ray.
    for (size_t i = 0; i < 16; ++i)
        if (i != 3) cut.Add(i, 3, 0);
    cut.Estimate(sky, {});
    EXPECT_LT(cut.Tiles()[3].visible, 0.2f);
    EXPECT_NEAR(cut.Tiles()[40].visible, 0.5f, 1e-4f);
}

TEST(SkyCut, WhatACellNearbySeesIsLookedForLonger) {
    const BuiltScene built = WithSky(false);
    SkyTiles sky(built.scene->Lights(), 0);
    SkyCut lit(sky.FirstCut(16), 0.5f), alone(sky.FirstCut(16), 1e-4f), beside(sky.FirstCut(16), 1e-4f);
    lit.Add(5, 100, 100);
    lit.Estimate(sky, {});
    const SkyCut *const near[] = {&lit};
    alone.Add(5, 100, 0);
    beside.Add(5, 100, 0);
    alone.Estimate(sky, {});
    beside.Estimate(sky, near);
    EXPECT_GT(beside.Tiles()[5].visible, 10 * alone.Tiles()[5].visible);
    EXPECT_LT(beside.Tiles()[5].visible, 1e-3f);
}

TEST(SkyCut, APartOfACellInheritsWhatIsKnown) {
    const BuiltScene built = WithSky(false);
    SkyTiles sky(built.scene->Lights(), 0);
    SkyCut cut(sky.FirstCut(16), 0.5f);
    cut.Add(4, 100, 25);
    cut.Estimate(sky, {});
    SkyCut part = cut.Inherited();
    EXPECT_EQ(part.Tiles()[4].visible, cut.Tiles()[4].visible);
    EXPECT_EQ(part.Tiles()[4].traced, 0u);
    part.Estimate(sky, {});
    EXPECT_NEAR(part.Tiles()[4].visible, cut.Tiles()[4].visible, 1e-5f) << "without rays nothing is learned";
}

/// The cells of a cube of side 2 around the origin, divided into the top grid and around some points.
SkyCells CubeOfCells(std::span<SkyTiles> skies, size_t tiles, std::span<const Point3> points) {
    const std::vector<std::vector<uint32_t>> cuts = {skies[0].FirstCut(tiles)};
    SkyCells cells(Bounds3(Point3(-1), Point3(1)), cuts, 0.5f, {});
    cells.Learn(skies, false);
    cells.DivideAround(points, skies);
    return cells;
}

TEST(SkyCells, KeysLeadToTheTileThatHoldsThem) {
    const BuiltScene built = WithSky(true);
    std::vector<SkyTiles> skies = {SkyTiles(built.scene->Lights(), 0)};
    const Point3 points[] = {Point3(0.5f), Point3(0.5f), Point3(-0.5f)};
    const SkyCells cells = CubeOfCells(skies, 50, points);
    EXPECT_GE(cells.CellCount(), 64u);
    Rng rng(4);
    for (int i = 0; i < 2000; ++i) {
        const Vector3 d = SampleUniformSphere(rng.Uniform2());
        const uint32_t key = skies[0].KeyTowards(d);
        const SkyCells::Row &row = cells.RowOf(cells.CellAt(Point3(0.1f)));
        const uint32_t number = cells.Number(cells.LaneOf(row, 0, key));
        EXPECT_LE(SkyTiles::KeyOf(number), key);
        EXPECT_GT(SkyTiles::KeyOf(number) + SkyTiles::KeyCount(number), key);
    }
}

TEST(SkyCells, DividesWhereTheAnswerDependsOnThePlace) {
    const BuiltScene built = WithSky(false);
    std::vector<SkyTiles> skies = {SkyTiles(built.scene->Lights(), 0)};
    SkyCells cells = CubeOfCells(skies, 64, {});
    const size_t before = cells.CellCount();
    // All of the sky is seen where x > 0.2, and nothing elsewhere; this border runs through the middle of cells.
    Rng rng(6);
    for (int round = 0; round < 3; ++round) {
        for (int i = 0; i < 40000; ++i) {
            const Point3 p(rng.Uniform() * 2 - 1, rng.Uniform() * 2 - 1, 0.1f);
            const Vector3 d = SampleUniformSphere(rng.Uniform2());
            const SkyCells::Row &row = cells.RowOf(cells.CellAt(p));
            cells.Count(cells.LaneOf(row, 0, skies[0].KeyTowards(d)), p.x > 0.2f);
        }
        cells.Learn(skies, true);
    }
    EXPECT_GT(cells.CellCount(), before);
    EXPECT_GT(cells.Octree().CellAt(Point3(0.2f, 0, 0.1f)).depth, cells.Octree().CellAt(Point3(-0.8f, 0, 0.1f)).depth);
    EXPECT_EQ(cells.Traced(), 120000u);
    const SkyCells::Row &seen = cells.RowOf(cells.CellAt(Point3(0.9f, 0, 0.1f)));
    EXPECT_TRUE(seen.isOpen);
    EXPECT_FALSE(cells.RowOf(cells.CellAt(Point3(-0.9f, 0, 0.1f))).isOpen);
}

}  // namespace
}  // namespace ext
