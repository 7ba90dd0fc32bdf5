#include <gtest/gtest.h>

#include <functional>
#include <set>

#include "pbrt/samplers/halton_sampler.h"
#include "pbrt/samplers/sobol_samplers.h"
#include "sampler_cases.h"

namespace pbrt::test {
namespace {

/// True if every box holds one of the n points, for n = points.size() boxes in `columns` columns and n / columns rows.
bool OneInEachBox(const std::vector<Point2> &points, size_t columns) {
    size_t rows = points.size() / columns;
    std::set<std::pair<size_t, size_t>> boxes;
    for (const Point2 &p : points) boxes.insert({size_t(p.x * Float(columns)), size_t(p.y * Float(rows))});
    return boxes.size() == points.size();
}
bool IsBase2Net(const std::vector<Point2> &points) {
    for (size_t columns = 1; columns <= points.size(); columns *= 2)
        if (!OneInEachBox(points, columns)) return false;
    return true;
}

/// The points that `draw` returns for the samples first ... first + n - 1 of a pixel; `before` 1D requests precede it.
template <class Draw>
std::vector<Point2> Points(Sampler &s, Point2i pixel, int first, int n, int before, const Draw &draw) {
    std::vector<Point2> points;
    for (int i = first; i < first + n; ++i) {
        s.StartPixelSample(pixel, i);
        for (int k = 0; k < before; ++k) s.Get1D();
        points.push_back(draw());
    }
    return points;
}
std::vector<Point2> Points2D(Sampler &s, Point2i pixel, int first, int n, int before) {
    return Points(s, pixel, first, n, before, [&] { return s.Get2D(); });
}
std::vector<Point2> Points1D(Sampler &s, Point2i pixel, int first, int n, int before) {
    return Points(s, pixel, first, n, before, [&] { return Point2(s.Get1D(), 0); });
}

TEST(Stratification, PaddedAndZSobolGiveEveryPixelANetInEveryRequest) {
    for (const char *type : {"paddedsobol", "zsobol"})
        for (const char *randomization : kRandomizations)
            for (int samples : {1, 2, 8, 16, 64}) {
                std::unique_ptr<Sampler> s = SamplerCase{type, randomization}.Make(samples, 3);
                for (int before : {0, 1, 5})
                    for (Point2i pixel : {Point2i(0, 0), Point2i(13, 40), Point2i(63, 47)})
                        for (int first : {0, samples}) {
                            EXPECT_TRUE(IsBase2Net(Points2D(*s, pixel, first, samples, before)))
                                << type << " " << randomization << " " << samples << " " << before;
                            EXPECT_TRUE(OneInEachBox(Points1D(*s, pixel, first, samples, before), size_t(samples)))
                                << type << " " << randomization;
                        }
            }
}

TEST(Stratification, ZSobolQuadsOfPixelsShareANet) {
    for (int samples : {1, 2, 4, 16}) {
        std::unique_ptr<Sampler> s = SamplerCase{"zsobol", "fastowen"}.Make(samples, 5);
        for (int size : {2, 4})
            for (Point2i corner : {Point2i(0, 0), Point2i(16, 8), Point2i(60, 44)})
                for (int before : {0, 3}) {
                    std::vector<Point2> all;
                    for (int y = 0; y < size; ++y)
                        for (int x = 0; x < size; ++x)
                            for (const Point2 &p : Points2D(*s, corner + Point2i(x, y), 0, samples, before))
                                all.push_back(p);
                    EXPECT_TRUE(IsBase2Net(all)) << samples << " " << size;
                }
    }
}

TEST(Stratification, ZSobolOrdersQuadsDifferentlyInDifferentDimensions) {
    // At one sample per pixel, the four pixels of a quad get the four quarters of the 1D values in some order: all 24
    // orders must occur.
    std::unique_ptr<Sampler> s = SamplerCase{"zsobol", "none"}.Make(1);
    std::set<std::vector<int>> orders;
    for (int dimension = 0; dimension < 300; ++dimension) {
        std::vector<int> order;
        Float low = 1;
        for (Point2i pixel : {Point2i(0, 0), Point2i(1, 0), Point2i(0, 1), Point2i(1, 1)}) {
            s->StartPixelSample(pixel, 0, dimension);
            Float u = s->Get1D();
            order.push_back(int(u * 4));
            low = std::min(low, u);
        }
        orders.insert(order);
    }
    EXPECT_EQ(orders.size(), 24u);
}

TEST(Stratification, StratifiedFillsEveryCellOnce) {
    DiagnosticSink sink;
    for (auto [nx, ny] : {std::pair{4, 4}, {3, 2}, {1, 7}})
        for (bool jitter : {true, false}) {
            const Params params = Params().Integer("xsamples", nx).Integer("ysamples", ny).Bool("jitter", jitter);
            std::unique_ptr<Sampler> s = Samplers().Make("stratified", params, SamplerContext{{8, 8}, 0, 1, sink});
            int n = nx * ny;
            ASSERT_EQ(s->SamplesPerPixel(), n);
            for (int before : {0, 1, 4})
                for (int first : {0, n}) {
                    std::vector<Point2> p2 = Points2D(*s, {3, 5}, first, n, before),
                                        p1 = Points1D(*s, {3, 5}, first, n, before);
                    EXPECT_TRUE(OneInEachBox(p2, size_t(nx)));
                    EXPECT_TRUE(OneInEachBox(p1, size_t(n)));
                    for (int i = 0; i < n && !jitter; ++i) {
                        auto centred = [](Float u, int cells) {
                            Float x = u * Float(cells);
                            return std::abs(x - std::floor(x) - 0.5f);
                        };
                        EXPECT_LT(centred(p2[i].x, nx), 1e-5f);
                        EXPECT_LT(centred(p2[i].y, ny), 1e-5f);
                        EXPECT_LT(centred(p1[i].x, n), 1e-5f);
                    }
                }
        }
    EXPECT_FALSE(sink.HasErrors());
}

TEST(Stratification, StratifiedTakesTheCellsInAnotherOrderEachTime) {
    std::unique_ptr<Sampler> s = SamplerCase{"stratified", ""}.Make(16);
    std::set<std::vector<int>> orders;
    for (int before = 0; before < 20; ++before) {
        std::vector<int> order;
        for (const Point2 &p : Points2D(*s, {1, 1}, 0, 16, before)) order.push_back(int(p.y * 4) * 4 + int(p.x * 4));
        orders.insert(order);
    }
    EXPECT_EQ(orders.size(), 20u);
}

TEST(Stratification, HaltonPixelsOwnTheirPointsOfTheDirectSequence) {
    for (Point2i resolution : {Point2i(16, 9), Point2i(200, 300), Point2i(1, 1), Point2i(1, 50)}) {
        HaltonSampler s({16, resolution, Randomization::None, 0});
        auto scale = s.TileScale();
        EXPECT_GE(scale.x, std::min(128, resolution.x));
        EXPECT_GE(scale.y, std::min(128, resolution.y));
        std::set<uint64_t> indices;
        size_t count = 0;
        for (int y = 0; y < std::min(resolution.y, 128); y += 7)
            for (int x = 0; x < std::min(resolution.x, 128); x += 3)
                for (int i = 0; i < 3; ++i, ++count) {
                    s.StartPixelSample({x, y}, i, 0);
                    indices.insert(s.Index());
                    double px = double(RadicalInverse(2, s.Index())) * scale.x,
                           py = double(RadicalInverse(3, s.Index())) * scale.y;
                    Point2 p = s.GetPixel2D();
                    // In float, the sequence gives positions in the tile only to some 1e-5 of a pixel.
                    ASSERT_NEAR(px, x + double(p.x), 3e-5) << x << " " << y << " " << i;
                    ASSERT_NEAR(py, y + double(p.y), 3e-5) << x << " " << y << " " << i;
                    ASSERT_EQ(s.Get1D(), RadicalInverse(5, s.Index()));
                    ASSERT_EQ(s.Get1D(), RadicalInverse(7, s.Index()));
                }
        EXPECT_EQ(indices.size(), count);
    }
}

TEST(Stratification, HaltonTilesRepeatAfter128Pixels) {
    HaltonSampler s({4, {400, 400}, Randomization::PermuteDigits, 0});
    s.StartPixelSample({5, 7}, 1, 0);
    uint64_t index = s.Index();
    s.StartPixelSample({5 + 128, 7 + 256}, 1, 0);
    EXPECT_EQ(s.Index(), index);
    s.StartPixelSample({5 - 128, 7}, 1, 0);
    EXPECT_EQ(s.Index(), index);
}

TEST(Stratification, HaltonDimensionsAreStratifiedAlongTheSequence) {
    // For 5^3 consecutive points of a 1 x 1 film, every interval of length 1/125 of dimension 2 (base 5) holds one.
    for (Randomization r : {Randomization::None, Randomization::PermuteDigits, Randomization::Owen}) {
        HaltonSampler s({125, {1, 1}, r, 9});
        std::set<int> cells;
        for (int i = 0; i < 125; ++i) {
            s.StartPixelSample({0, 0}, i, 0);
            cells.insert(int(double(s.Get1D()) * 125 + 1e-4));
        }
        EXPECT_EQ(cells.size(), 125u);
    }
}

TEST(Stratification, SobolPixelsAreStratifiedAndPointsAreTheGlobalOnes) {
    for (Point2i resolution : {Point2i(64, 48), Point2i(33, 1), Point2i(1, 1), Point2i(1920, 1080)}) {
        SobolSampler s({16, resolution, Randomization::None, 0});
        int scale = int(std::bit_ceil(unsigned(std::max(resolution.x, resolution.y))));
        const uint32_t *m = SobolMatrices();
        for (Point2i pixel : {Point2i(0, 0), resolution - 1, resolution / 2}) {
            std::vector<Point2> inPixel;
            for (int i = 0; i < 16; ++i) {
                s.StartPixelSample(pixel, i, 0);
                Point2 p = s.GetPixel2D();
                inPixel.push_back(p);
                double x = double(SobolBits(m, s.Index())) * 0x1p-32 * scale,
                       y = double(SobolBits(m + SobolIndexBits, s.Index())) * 0x1p-32 * scale;
                ASSERT_NEAR(x, pixel.x + double(p.x), 1e-6);
                ASSERT_NEAR(y, pixel.y + double(p.y), 1e-6);
                ASSERT_EQ(s.Get1D(), SobolToFloat(SobolBits(m + 2 * SobolIndexBits, s.Index())));
                ASSERT_EQ(s.Get1D(), SobolToFloat(SobolBits(m + 3 * SobolIndexBits, s.Index())));
            }
            EXPECT_TRUE(OneInEachBox(inPixel, 4)) << resolution.x;
        }
    }
}

TEST(Stratification, SobolFilmIsStratifiedAcrossPixelsInEveryDimension) {
    // One sample in each of 32 x 32 pixels: these are 1024 consecutive points of the sequence.
    for (const char *randomization : {"none", "owen", "fastowen"}) {
        std::unique_ptr<Sampler> s = SamplerCase{"sobol", randomization, false}.Make(1, 2, {32, 32});
        for (int dimension : {2, 3, 20, 500, 1023}) {
            std::set<int> cells;
            for (int y = 0; y < 32; ++y)
                for (int x = 0; x < 32; ++x) {
                    s->StartPixelSample({x, y}, 0, dimension);
                    cells.insert(int(s->Get1D() * 1024));
                }
            EXPECT_EQ(cells.size(), 1024u) << dimension;
        }
    }
}

}  // namespace
}  // namespace pbrt::test
