#include "ext/lab/tile_statistics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pbrt/core/error.h"
#include "pbrt/images/metrics.h"
#include "pbrt/math/rng.h"

namespace ext::lab {

TEST(TileGrid, CoversEveryPixelOnce) {
    for (Point2i size : {Point2i(64, 48), Point2i(67, 41), Point2i(5, 9), Point2i(8, 1)}) {
        const TileGrid grid(size);
        std::vector<int> hits(size_t(size.x * size.y));
        for (int ty = 0; ty < grid.tilesY; ++ty)
            for (int tx = 0; tx < grid.tilesX; ++tx) {
                const Bounds2i b = grid.Pixels(tx, ty);
                EXPECT_GE(b.high.x - b.low.x, std::min(8, size.x));
                EXPECT_GE(b.high.y - b.low.y, std::min(8, size.y));
                for (int y = b.low.y; y < b.high.y; ++y)
                    for (int x = b.low.x; x < b.high.x; ++x) ++hits[size_t(y * size.x + x)];
            }
        for (int h : hits) EXPECT_EQ(h, 1);
    }
}

TEST(TileMeans, AreMeansOfTheColorChannels) {
    Image image(PixelFormat::Float, {20, 9}, {"N.X", "R", "G", "B"});
    for (int y = 0; y < 9; ++y)
        for (int x = 0; x < 20; ++x) {
            image.Set({x, y}, 0, 99);
            image.Set({x, y}, 1, Float(x));
            image.Set({x, y}, 2, Float(y));
            image.Set({x, y}, 3, 2);
        }
    image.Set({0, 0}, 3, NAN);
    const TileMeans means = ComputeTileMeans(image);
    ASSERT_EQ(means.grid.Count(), 2);  // one covers the columns 0 to 7, one 8 to 19
    ASSERT_EQ(means.channels, 3);
    EXPECT_DOUBLE_EQ(means(0, 0), 3.5);
    EXPECT_DOUBLE_EQ(means(1, 0), 13.5);
    EXPECT_DOUBLE_EQ(means(1, 1), 4);
    EXPECT_DOUBLE_EQ(means(0, 2), 2);
}

// The relL2 that the average states for itself is its true one; here the truth is known.
TEST(AverageImages, EstimatesItsOwnNoise) {
    Rng rng(3, 3);
    const int n = 6;
    Image truth(PixelFormat::Float, {80, 60}, {"R", "G", "B"});
    std::vector<Image> images(n, truth);
    ForEachValue(truth, [&](Point2i p, int c) {
        const Float value = 1 + 0.02f * Float(p.x + c);
        truth.Set(p, c, value);
        for (Image &image : images) image.Set(p, c, value * (0.5f + rng.Uniform()));
    });
    const MeanImage mean = AverageImages(images);
    const double error = ImageError(mean.image, truth, Metric::RelL2);
    EXPECT_NEAR(mean.noise, error, 0.06 * error);
    EXPECT_NEAR(error, 1.0 / 12 / n, 0.1 / 12 / n);
    EXPECT_EQ(AverageImages(std::vector<Image>{truth}).noise, 0);
    EXPECT_THROW(AverageImages({}), UserError);
    const Image small(PixelFormat::Float, {2, 2}, {"R", "G", "B"});
    EXPECT_THROW(AverageImages(std::vector<Image>{truth, small}), UserError);
}

}  // namespace ext::lab
