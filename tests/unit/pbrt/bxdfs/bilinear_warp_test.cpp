#include "pbrt/bxdfs/measured.h"

#include <gtest/gtest.h>

#include <limits>

#include "pbrt/math/rng.h"
#include "support/statistics.h"

namespace pbrt::test {
namespace {

/// Two slices of 4 x 3 knots, some of which are 0.
GridSlices Grid() {
    return {{0, 1, 4, 2, 3, 0, 0, 5, 1, 1, 2, 0,  //
             7, 0, 0, 0, 1, 2, 3, 4, 0, 0, 9, 1},
            4,
            3};
}
const SliceBlend kBlends[] = {{{0, 0, 0, 0}, {1, 0, 0, 0}}, {{0, 1, 1, 0}, {.3f, .2f, .5f, 0}}};

/// The reference: each slice is normalised to integrate to 1, and then the slices are mixed.
double Expected(const Point2 &p, const SliceBlend &blend) {
    GridSlices grid = Grid();
    double sum = 0;
    for (size_t k = 0; k < 4; ++k) {
        double total = 0;
        for (int y = 0; y < 3; ++y)
            for (int x = 0; x < 4; ++x)
                total += double(grid.At(blend.slice[k], x, y)) * (x % 3 ? 1 : 0.5) * (y % 2 ? 1 : 0.5) / 6;
        sum += double(blend.weight[k]) * double(grid.Evaluate(p, blend.slice[k])) / total;
    }
    return sum;
}

TEST(GridSlices, IsBilinearAndHoldsAtTheEdges) {
    GridSlices grid = Grid();
    EXPECT_FLOAT_EQ(grid.Evaluate({1.f / 3, .5f}, 0), 0);
    EXPECT_FLOAT_EQ(grid.Evaluate({.5f, .25f}, 0), (1 + 4 + 0 + 0) / 4.f);
    EXPECT_FLOAT_EQ(grid.Evaluate({1, 1}, 1), 1);
    EXPECT_FLOAT_EQ(grid.Evaluate({2, -1}, 0), 2);
    // A vanishing half vector gives NaN, which must not become an index.
    const Float nan = std::numeric_limits<Float>::quiet_NaN();
    EXPECT_FLOAT_EQ(grid.Evaluate({nan, nan}, 1), 7);
}

TEST(BilinearWarp, SamplesFollowTheirDensityAndInvert) {
    BilinearWarp warp((Grid()));
    constexpr int kCells = 24, kSamples = 100000, kSub = 8;
    for (const SliceBlend &blend : kBlends) {
        std::vector<double> observed(kCells * kCells), expected(kCells * kCells);
        Rng rng(1);
        for (int i = 0; i < kSamples; ++i) {
            Point2 u = rng.Uniform2();
            BilinearWarp::Mapped there = warp.Sample(u, blend);
            int x = std::min(int(there.p.x * kCells), kCells - 1);
            int y = std::min(int(there.p.y * kCells), kCells - 1);
            ++observed[size_t(y * kCells + x)];
            if (i >= 2000) continue;
            EXPECT_NEAR(double(there.pdf), Expected(there.p, blend), 1e-3);
            BilinearWarp::Mapped back = warp.Invert(there.p, blend);
            EXPECT_NEAR(back.pdf, there.pdf, 1e-3f);
            if (there.pdf > 0.05f) {
                EXPECT_NEAR(back.p.x, u.x, 2e-3f);
                EXPECT_NEAR(back.p.y, u.y, 2e-3f);
            }
        }
        double total = 0;
        for (int j = 0; j < kCells * kSub; ++j)
            for (int i = 0; i < kCells * kSub; ++i) {
                Point2 p((Float(i) + .5f) / (kCells * kSub), (Float(j) + .5f) / (kCells * kSub));
                double mass = double(warp.Invert(p, blend).pdf) / Sqr(kCells * kSub);
                total += mass;
                expected[size_t(j / kSub * kCells + i / kSub)] += mass * kSamples;
            }
        EXPECT_NEAR(total, 1, 1e-3);
        EXPECT_GT(ChiSquareTest(observed, expected), 1e-5);
    }
}

}  // namespace
}  // namespace pbrt::test
