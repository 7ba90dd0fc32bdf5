#include "pbrt/samplers/pmj02bn_sampler.h"

#include <gtest/gtest.h>

#include <set>

#include "sampler_cases.h"
#include "support/sampling.h"
#include "support/statistics.h"

namespace pbrt::test {
namespace {

bool IsNet(std::span<const BinaryPoint> points) { return test::IsNet(points); }

TEST(Pmj02bnSequence, EveryAlignedRunIsANet) {
    for (uint64_t seed : {1, 2}) {
        const std::vector<BinaryPoint> points = MakePmj02bn(12, 5, seed);
        ASSERT_EQ(points.size(), 4096u);
        for (int m = 0; m <= 12; ++m)
            for (size_t first = 0; first < points.size(); first += size_t(1) << m)
                ASSERT_TRUE(IsNet({&points[first], size_t(1) << m})) << m << " " << first;
        std::vector<BinaryPoint> broken = points;
        std::swap(broken[3].x, broken[9].x);
        EXPECT_FALSE(IsNet({broken.data(), 8})) << "IsNet must reject a broken net";
    }
}

TEST(Pmj02bnSequence, TheSamplersSetsAreNetsAndDiffer) {
    for (int set = 0; set < Pmj02bnSampler::SetCount; ++set) {
        const std::vector<BinaryPoint> &points = Pmj02bnSampler::Set(set);
        ASSERT_EQ(points.size(), size_t(1) << Pmj02bnSampler::SetLog2Count);
        for (int m = 0; m <= Pmj02bnSampler::SetLog2Count; ++m)
            EXPECT_TRUE(IsNet({points.data(), size_t(1) << m})) << set << " " << m;
        EXPECT_EQ(points[0].x == Pmj02bnSampler::Set(0)[0].x, set == 0);
    }
}

/// Mean distance to the nearest other point, in units of 1 / sqrt(n); distances wrap around.
double MeanNearest(std::span<const BinaryPoint> points) {
    double sum = 0;
    for (const BinaryPoint &p : points) {
        double nearest = 9;
        for (const BinaryPoint &q : points) {
            if (&p == &q) continue;
            const double u = int32_t(q.x - p.x) * 0x1p-32, v = int32_t(q.y - p.y) * 0x1p-32;
            nearest = std::min(nearest, std::hypot(u, v));
        }
        sum += nearest;
    }
    return sum / std::sqrt(double(points.size()));
}

TEST(Pmj02bnSequence, PointsKeepFartherApartThanOtherNetsDo) {
    for (size_t count : {16, 64, 256, 1024}) {
        RunningStatistics blue, plain;
        for (uint64_t seed = 0; seed < 6; ++seed) {
            const std::vector<BinaryPoint> searched = MakePmj02bn(10, 5, seed), drawn = MakePmj02bn(10, 0, seed);
            blue.Add(MeanNearest({searched.data(), count}));
            plain.Add(MeanNearest({drawn.data(), count}));
        }
        EXPECT_GT(blue.mean, plain.mean + 0.05) << count;
        // For comparison: a hexagonal grid has 1.07, independent points have 0.5.
        EXPECT_GT(blue.mean, 0.7) << count;
        EXPECT_LT(blue.mean, 1.07) << count;
    }
}

TEST(BlueNoiseMask, HoldsEveryRankOnceAndNearRanksApart) {
    const BlueNoiseMask mask(0);
    constexpr uint32_t kSize = BlueNoiseMask::Size;
    std::set<uint32_t> ranks;
    for (uint32_t y = 0; y < kSize; ++y)
        for (uint32_t x = 0; x < kSize; ++x) ranks.insert(mask.Rank(x, y));
    EXPECT_EQ(ranks.size(), kSize * kSize);
    EXPECT_EQ(*ranks.rbegin(), kSize * kSize - 1);
    EXPECT_EQ(mask.Rank(3, 5), mask.Rank(3 + kSize, 5 + 7 * kSize));
    // The variance of means over 4 x 4 pixels would be a sixteenth of that of a pixel for white noise; here it must be
    // much lower.
    RunningStatistics pixels, blocks;
    for (uint32_t y = 0; y < kSize; ++y)
        for (uint32_t x = 0; x < kSize; ++x) {
            double sum = 0;
            for (uint32_t k = 0; k < 16; ++k) sum += mask.Rank(x + k % 4, y + k / 4);
            blocks.Add(sum / 16);
            pixels.Add(mask.Rank(x, y));
        }
    EXPECT_LT(blocks.Variance(), 0.3 * pixels.Variance() / 16);
}

std::unique_ptr<Sampler> MakePmj02bnSampler(int samples, int seed = 0) {
    return SamplerCase{"pmj02bn", ""}.Make(samples, seed);
}

BinaryPoint Fractions(const Point2 &p) {
    auto fraction = [](Float u) { return uint32_t(double(u) * 0x1p32); };
    return {fraction(p.x), fraction(p.y)};
}

/// The points that one 2D request returns for `n` samples of a pixel.
std::vector<BinaryPoint> Request(Sampler &s, Point2i pixel, int first, int n, int dimension) {
    std::vector<BinaryPoint> points;
    for (int i = first; i < first + n; ++i) {
        s.StartPixelSample(pixel, i, dimension);
        points.push_back(Fractions(s.Get2D()));
    }
    return points;
}

TEST(Pmj02bnSampler, EveryRequestIsANetAndSoAreItsBeginnings) {
    for (int samples : {1, 2, 16, 32, 64})
        for (Point2i pixel : {Point2i(0, 0), Point2i(13, 40), Point2i(700, 300)})
            for (int dimension : {2, 4, 7, 30}) {
                std::unique_ptr<Sampler> s = MakePmj02bnSampler(samples, 2);
                for (int first : {0, samples, 5 * samples})
                    EXPECT_TRUE(IsNet(Request(*s, pixel, first, samples, dimension))) << samples << " " << dimension;
                for (int n = 1; n < samples; n *= 4) EXPECT_TRUE(IsNet(Request(*s, pixel, 0, n, dimension))) << n;
            }
}

TEST(Pmj02bnSampler, FlipsAndOrdersDifferFromPixelToPixel) {
    std::unique_ptr<Sampler> s = MakePmj02bnSampler(16);
    std::set<uint32_t> firsts;
    std::set<std::vector<int>> orders;
    for (int x = 0; x < 20; ++x) {
        const std::vector<BinaryPoint> points = Request(*s, {x, 7}, 0, 16, 2);
        firsts.insert(points[0].x);
        std::vector<int> order(16);
        for (int i = 0; i < 16; ++i)
            for (int k = 0; k < 16; ++k) order[i] += points[k].x < points[i].x;
        orders.insert(order);
    }
    EXPECT_EQ(firsts.size(), 20u);
    EXPECT_GE(orders.size(), 19u);
}

TEST(Pmj02bnSampler, PositionsInThePixelAreNetsInEveryRound) {
    for (int samples : {1, 4, 16, 256}) {
        std::unique_ptr<Sampler> s = MakePmj02bnSampler(samples, 3);
        for (Point2i pixel : {Point2i(0, 0), Point2i(63, 47), Point2i(900, 11)})
            for (int round : {0, 1}) {
                std::vector<BinaryPoint> points;
                for (int i = 0; i < samples; ++i) {
                    s->StartPixelSample(pixel, round * samples + i);
                    points.push_back(Fractions(s->GetPixel2D()));
                    if (std::has_single_bit(unsigned(i + 1))) {
                        EXPECT_TRUE(IsNet(points)) << samples << " " << i;
                    }
                }
            }
    }
}

TEST(Pmj02bnSampler, PositionsOfATileAreOneNet) {
    // 16 samples in each of 8 x 8 pixels are 1024 points in 1024 cells, and in as many columns and rows.
    std::unique_ptr<Sampler> s = MakePmj02bnSampler(16);
    std::vector<uint32_t> taken(32 * 32, 0);
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x)
            for (int i = 0; i < 16; ++i) {
                s->StartPixelSample({x, y}, i);
                const Point2 p = Point2(x, y) + s->GetPixel2D();
                ++taken[size_t(p.x * 4) * 32 + size_t(p.y * 4)];
            }
    for (uint32_t n : taken) EXPECT_EQ(n, 1u);
}

/// Root mean square error of the means of f over the samples of a pixel.
template <class F>
double PixelError(const SamplerCase &c, int samples, double truth, F f) {
    double sum = 0;
    std::unique_ptr<Sampler> s = c.Make(samples);
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x) {
            double mean = 0;
            for (int i = 0; i < samples; ++i) {
                s->StartPixelSample({3 * x, 2 * y}, i, 4);
                mean += f(s->Get2D()) / samples;
            }
            sum += (mean - truth) * (mean - truth);
        }
    return std::sqrt(sum / 256);
}

TEST(Pmj02bnSampler, ErrorsFallAsThoseOfANetNotAsThoseOfIndependentSamples) {
    auto disk = [](const Point2 &p) { return p.x * p.x + p.y * p.y < 0.64f ? 1.0 : 0.0; };
    auto smooth = [](const Point2 &p) { return std::exp(-double(p.x * p.x + p.y * p.y)); };
    const double diskMean = M_PI / 4 * 0.64, e = std::erf(1.0) * std::sqrt(M_PI) / 2, smoothMean = e * e;
    const SamplerCase pmj{"pmj02bn", ""}, independent{"independent", ""};
    // The error of independent samples halves from 64 to 256 samples.
    EXPECT_NEAR(PixelError(independent, 256, diskMean, disk) / PixelError(independent, 64, diskMean, disk), 0.5, 0.1);
    EXPECT_LT(PixelError(pmj, 256, diskMean, disk), 0.4 * PixelError(independent, 256, diskMean, disk));
    EXPECT_LT(PixelError(pmj, 256, diskMean, disk) / PixelError(pmj, 64, diskMean, disk), 0.45);
    EXPECT_LT(PixelError(pmj, 256, smoothMean, smooth), 0.1 * PixelError(independent, 256, smoothMean, smooth));
    EXPECT_LT(PixelError(pmj, 256, smoothMean, smooth) / PixelError(pmj, 64, smoothMean, smooth), 0.4);
}

TEST(Pmj02bnSampler, ErrorsOfNeighbouringPixelsCancel) {
    // At one sample per pixel, means over 4 x 4 pixels have a smaller error with blue noise than with white noise.
    auto blockError = [](const SamplerCase &c) {
        RunningStatistics squares;
        std::unique_ptr<Sampler> s = c.Make(1);
        for (int by = 0; by < 12; ++by)
            for (int bx = 0; bx < 16; ++bx) {
                double sum = 0;
                for (int k = 0; k < 16; ++k) {
                    s->StartPixelSample({4 * bx + k % 4, 4 * by + k / 4}, 0, 5);
                    sum += double(s->Get1D()) - 0.5;
                }
                squares.Add(sum * sum);
            }
        return squares.mean;
    };
    EXPECT_LT(blockError({"pmj02bn", ""}), 0.4 * blockError({"independent", ""}));
}

}  // namespace
}  // namespace pbrt::test
