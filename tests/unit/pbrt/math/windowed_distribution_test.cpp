#include "pbrt/math/distributions.h"

#include <gtest/gtest.h>

#include "pbrt/math/rng.h"
#include "support/statistics.h"

namespace pbrt::test {
namespace {

struct Table {
    int nx, ny;
    std::vector<Float> f;
    WindowedPiecewiseConstant2D distribution;

    Table(int x, int y, Rng &rng, bool sparse) : nx(x), ny(y) {
        for (int i = 0; i < x * y; ++i)
            f.push_back(sparse && rng.Uniform() < 0.7f ? 0 : (rng.Uniform() < 0.05f ? 500 : 1) * rng.Uniform());
        distribution = WindowedPiecewiseConstant2D(f, nx, ny);
    }
    /// The reference: the integral over a window, summed cell by cell.
    double SlowIntegral(const Bounds2 &w) const {
        double sum = 0;
        for (int j = 0; j < ny; ++j)
            for (int i = 0; i < nx; ++i) {
                auto overlap = [](double lo, double hi, int k, int n) {
                    return std::max(0.0, std::min(hi, (k + 1.0) / n) - std::max(lo, double(k) / n));
                };
                sum += double(f[size_t(j * nx + i)]) * overlap(double(w.low.x), double(w.high.x), i, nx) *
                       overlap(double(w.low.y), double(w.high.y), j, ny);
            }
        return sum;
    }
};

Bounds2 RandomWindow(Rng &rng, Float least) {
    auto interval = [&](Float &low, Float &high) {
        Float size = least + (1 - least) * Sqr(rng.Uniform());
        low = (1 - size) * rng.Uniform();
        high = std::min(low + size, Float(1));
    };
    Bounds2 w;
    interval(w.low.x, w.high.x);
    interval(w.low.y, w.high.y);
    return w;
}

TEST(WindowedDistribution, IntegralEqualsTheSumOverCells) {
    Rng rng(1);
    for (int k = 0; k < 300; ++k) {
        Table t(1 + int(rng.UniformInt(20)), 1 + int(rng.UniformInt(20)), rng, k % 2 == 0);
        Bounds2 w = k % 7 == 0 ? Bounds2{{0, 0}, {1, 1}} : RandomWindow(rng, 0.001f);
        double slow = t.SlowIntegral(w);
        EXPECT_NEAR(t.distribution.Integral(w), slow, 1e-9 + 1e-9 * slow);
        const auto outwards = [](Float v, int n, bool up) {
            const Float cells = v * Float(n);
            return (up ? std::ceil(cells) : std::floor(cells)) / Float(n);
        };
        const Bounds2 around{{outwards(w.low.x, t.nx, false), outwards(w.low.y, t.ny, false)},
                             {outwards(w.high.x, t.nx, true), outwards(w.high.y, t.ny, true)}};
        EXPECT_NEAR(t.distribution.IntegralAround(w), t.SlowIntegral(around), 1e-5 * (1 + t.SlowIntegral(around)));
    }
}

TEST(WindowedDistribution, SamplesFollowTheDensity) {
    Rng rng(2);
    constexpr int kCases = 60, kSide = 6, kSamples = 6000;
    const double alpha = SidakAlpha(1e-3, kCases);
    for (int k = 0; k < kCases; ++k) {
        Table t(1 + int(rng.UniformInt(16)), 1 + int(rng.UniformInt(16)), rng, k % 2 == 0);
        Bounds2 w = RandomWindow(rng, k % 3 == 0 ? 0.01f : 0.3f);
        double integral = t.SlowIntegral(w);
        if (!(integral > 0)) {
            Float pdf = 0;
            EXPECT_FALSE(t.distribution.Sample(rng.Uniform2(), w, &pdf));
            EXPECT_EQ(t.distribution.Pdf(w.Lerp({0.5f, 0.5f}), w), 0);
            continue;
        }
        std::vector<double> observed(kSide * kSide), expected(kSide * kSide);
        Vector2 size = (w.high - w.low) / Float(kSide);
        for (int j = 0; j < kSide; ++j)
            for (int i = 0; i < kSide; ++i) {
                Point2 low = w.low + size * Vector2(Float(i), Float(j));
                expected[size_t(j * kSide + i)] = t.SlowIntegral({low, low + size}) / integral * kSamples;
            }
        for (int s = 0; s < kSamples; ++s) {
            Float pdf = 0;
            auto p = t.distribution.Sample(rng.Uniform2(), w, &pdf);
            ASSERT_TRUE(p);
            ASSERT_TRUE(p->x >= w.low.x && p->x <= w.high.x && p->y >= w.low.y && p->y <= w.high.y);
            auto cell = [](Float x, int n) { return std::clamp(int(x * Float(n)), 0, n - 1); };
            double value = double(t.f[size_t(cell(p->y, t.ny) * t.nx + cell(p->x, t.nx))]);
            ASSERT_NEAR(double(pdf), value / integral, 1e-5 * value / integral);
            ASSERT_EQ(pdf, t.distribution.Pdf(*p, w));
            Point2 in = (*p - w.low) / size;
            observed[size_t(std::clamp(int(in.y), 0, kSide - 1) * kSide + std::clamp(int(in.x), 0, kSide - 1))] += 1;
        }
        // Rounding at the border may put a sample into a cell of zero weight.
        for (size_t i = 0; i < expected.size(); ++i)
            if (expected[i] < 1e-6 && observed[i] < 3) observed[i] = 0;
        EXPECT_GT(ChiSquareTest(observed, expected), alpha) << k;
    }
}

TEST(WindowedDistribution, SamplesKeepTheOrderOfTheNumbers) {
    // Stratified numbers stay stratified: the map is monotone in x, and in y at equal x.
    Rng rng(3);
    Table t(9, 7, rng, false);
    Bounds2 w = RandomWindow(rng, 0.4f);
    Float pdf = 0, last = -1;
    for (int i = 0; i < 100; ++i) {
        Float x = t.distribution.Sample({Float(i) / 100, 0.3f}, w, &pdf)->x;
        EXPECT_GE(x, last);
        last = x;
    }
}

TEST(WindowedDistribution, NothingOutsideTheWindow) {
    Rng rng(4);
    Table t(5, 5, rng, false);
    Bounds2 w{{0.2f, 0.3f}, {0.6f, 0.5f}};
    EXPECT_EQ(t.distribution.Pdf({0.1f, 0.4f}, w), 0);
    EXPECT_EQ(t.distribution.Pdf({0.3f, 0.6f}, w), 0);
    EXPECT_GT(t.distribution.Pdf({0.3f, 0.4f}, w), 0);
    Float pdf = 0;
    EXPECT_FALSE(t.distribution.Sample({0.5f, 0.5f}, {{0.4f, 0.4f}, {0.4f, 0.8f}}, &pdf)) << "a window without area";
}

}  // namespace
}  // namespace pbrt::test
