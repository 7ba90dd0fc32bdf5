#include "pbrt/math/distributions.h"

#include <gtest/gtest.h>

#include "pbrt/math/rng.h"
#include "support/statistics.h"

namespace pbrt {
namespace {

constexpr int kGrid = 1 << 18;
/// Centre of the i-th of kGrid equal pieces of [0, 1).
Float GridU(int i) { return (Float(i) + 0.5f) / kGrid; }

std::vector<Float> RandomWeights(Rng &rng, size_t n) {
    std::vector<Float> w(n);
    for (Float &v : w) v = rng.Uniform() < 0.3f ? 0 : std::exp(6 * rng.Uniform());
    w[rng.UniformInt(uint32_t(n))] = 1;
    return w;
}

TEST(PiecewiseConstant1D, SharesOfSamplesAreTheIntegralsOfTheDensity) {
    std::vector<Float> f = {0, 1, 4, 0, 0.5f, -2, 0};
    PiecewiseConstant1D d(f, -1, 2.5f);
    EXPECT_FLOAT_EQ(d.Integral(), 3.75f);
    std::vector<double> share(f.size(), 0);
    for (int i = 0; i < kGrid; ++i) {
        auto s = d.Sample(GridU(i));
        ASSERT_GE(s.x, -1);
        ASSERT_LT(s.x, 2.5f);
        EXPECT_EQ(s.index, int(std::floor(2 * (s.x + 1))));
        EXPECT_EQ(s.pdf, d.Pdf(s.x));
        EXPECT_FLOAT_EQ(s.pdf, std::abs(f[size_t(s.index)]) / 3.75f);
        ++share[size_t(s.index)];
    }
    for (size_t i = 0; i < f.size(); ++i) EXPECT_NEAR(share[i] / kGrid, double(std::abs(f[i])) / 7.5, 2.0 / kGrid);
    EXPECT_EQ(d.Pdf(-1.01f), 0);
    EXPECT_EQ(d.Pdf(2.51f), 0);
}

TEST(PiecewiseConstant1D, SamplesAreUniformInsideAPiece) {
    std::vector<Float> f = {1, 7};
    PiecewiseConstant1D d(f, 0, 2);
    test::RunningStatistics inside;
    Float previous = -1;
    for (int i = 0; i < kGrid; ++i) {
        auto s = d.Sample(GridU(i));
        EXPECT_GE(s.x, previous);  // inversion of the CDF is monotone
        previous = s.x;
        if (s.index == 1) inside.Add(double(s.x) - 1);
    }
    EXPECT_NEAR(inside.mean, 0.5, 1e-4);
    EXPECT_NEAR(inside.Variance(), 1.0 / 12, 1e-4);
}

TEST(PiecewiseConstant1D, NothingEmptyIsEverSampled) {
    Rng rng(1);
    for (int t = 0; t < 300; ++t) {
        std::vector<Float> f = RandomWeights(rng, 1 + rng.UniformInt(40));
        PiecewiseConstant1D d(f);
        for (int i = 0; i < 200; ++i) {
            Float u = i == 0 ? 0 : i == 1 ? OneMinusEpsilon : rng.Uniform();
            auto s = d.Sample(u);
            ASSERT_GT(s.pdf, 0);
            ASSERT_GT(f[size_t(s.index)], 0);
            ASSERT_TRUE(s.x >= 0 && s.x < 1);
        }
    }
}

TEST(PiecewiseConstant1D, FindsThePieceThatASearchFromTheLeftFinds) {
    Rng rng(5);
    for (int t = 0; t < 200; ++t) {
        // Powers of two are added without rounding, so u can be exactly at the end of a piece.
        std::vector<Float> f(1 + rng.UniformInt(67));
        double sum = 0;
        for (Float &v : f) {
            v = rng.Uniform() < 0.4f ? 0 : Float(1u << rng.UniformInt(4));
            sum += double(v);
        }
        if (!(sum > 0)) continue;
        PiecewiseConstant1D d(f);
        double running = 0;
        for (size_t k = 0; k < f.size(); ++k, running += double(f[k - 1])) {
            const Float u = Float(running / sum);
            if (u >= 1) break;
            double end = 0;
            size_t expected = 0;
            for (size_t i = 0; i < f.size(); ++i) {
                if (Float(end / sum) <= u) expected = i;
                end += double(f[i]);
            }
            EXPECT_EQ(d.Sample(u).index, int(expected)) << "u " << u << ", pieces " << f.size();
        }
    }
}

TEST(PiecewiseConstant1D, AllZeroIsUniform) {
    std::vector<Float> f(5, 0);
    PiecewiseConstant1D d(f, 0, 10);
    EXPECT_EQ(d.Integral(), 0);
    for (Float u : {0.f, 0.3f, 0.77f, OneMinusEpsilon}) {
        EXPECT_NEAR(d.Sample(u).x, 10 * u, 1e-5f);
        EXPECT_FLOAT_EQ(d.Sample(u).pdf, 0.1f);
        EXPECT_FLOAT_EQ(d.Pdf(10 * u), 0.1f);
    }
}

TEST(PiecewiseConstant2D, SharesOfSamplesAreTheIntegralsOfTheDensity) {
    std::vector<Float> f = {0, 1, 2, 0, 0, 0, 5, 0, 4, 1, 1, 1};  // 3 x 4
    PiecewiseConstant2D d(f, 3, 4);
    Float mean = 15.f / 12;
    std::vector<double> share(f.size(), 0);
    constexpr int kN = 1024;
    for (int j = 0; j < kN; ++j)
        for (int i = 0; i < kN; ++i) {
            const auto [p, pdf, value] = d.Sample({(Float(i) + 0.5f) / kN, (Float(j) + 0.5f) / kN});
            auto cell = size_t(std::floor(p.y * 4) * 3 + std::floor(p.x * 3));
            ASSERT_LT(cell, f.size());
            ASSERT_NEAR(pdf, f[cell] / mean, 4e-6f);
            ASSERT_EQ(pdf, d.Pdf(p));
            ++share[cell];
        }
    for (size_t i = 0; i < f.size(); ++i) EXPECT_NEAR(share[i] / (kN * kN), double(f[i] / mean) / 12, 0.003) << i;
    EXPECT_EQ(d.Pdf({0, 1.1f}), 0);
    EXPECT_EQ(d.Pdf({1.1f, 0.5f}), 0);
    EXPECT_EQ(d.Pdf({-1.1f, 4}), 0);
}

TEST(PiecewiseConstantGrid, ValuesBelongToTheSampledCells) {
    const std::vector<Float> f = {3, 1, 0, 2, 5, 1, 0, 4};  // 4 x 2
    PiecewiseConstantGrid<int> d(f, 4, 2);
    for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 4; ++x) d.ValueOf(x, y) = 10 * y + x;
    Rng rng(3);
    for (int i = 0; i < 1000; ++i) {
        const auto [p, pdf, value] = d.Sample(rng.Uniform2());
        EXPECT_EQ(value, 10 * int(2 * p.y) + int(4 * p.x));
        EXPECT_EQ(value, d.ValueAt(p));
    }
}

TEST(AliasTable, SharesOfUAreThePmf) {
    Rng rng(2);
    for (size_t n : {size_t(1), size_t(2), size_t(3), size_t(10), size_t(129)}) {
        std::vector<Float> w = RandomWeights(rng, n);
        double sum = 0;
        for (Float v : w) sum += double(v);
        AliasTable table(w);
        std::vector<double> share(n, 0);
        for (int i = 0; i < kGrid; ++i) {
            auto s = table.Sample(GridU(i));
            ASSERT_EQ(s.pmf, table.PMF(s.index));
            ASSERT_GT(s.pmf, 0);
            ++share[size_t(s.index)];
        }
        double total = 0;
        for (size_t i = 0; i < n; ++i) {
            // Every border of a column costs at most one grid point, and an entry can have a share in every column.
            EXPECT_NEAR(share[i] / kGrid, double(w[i]) / sum, 2.0 * double(n) / kGrid);
            EXPECT_NEAR(double(table.PMF(int(i))), double(w[i]) / sum, 1e-6);
            total += double(table.PMF(int(i)));
        }
        EXPECT_NEAR(total, 1, 1e-5);
    }
}

TEST(AliasTable, NothingEmptyIsEverSampled) {
    Rng rng(3);
    for (int t = 0; t < 2000; ++t) {
        std::vector<Float> w = RandomWeights(rng, 1 + rng.UniformInt(30));
        if (t % 3 == 0)  // equal weights in numbers that make every share round
            for (Float &v : w) v = v > 0 ? 0.1f : 0;
        AliasTable table(w);
        for (size_t column = 0; column < w.size(); ++column)
            for (Float f : {0.f, 0.5f, 0.99999f}) {
                auto s = table.Sample((Float(column) + f) / Float(w.size()));
                ASSERT_GT(w[size_t(s.index)], 0) << t;
            }
    }
}

TEST(AliasTable, AllZeroIsUniform) {
    std::vector<Float> w(4, 0);
    AliasTable table(w);
    for (int i = 0; i < 4; ++i) {
        EXPECT_EQ(table.PMF(i), 0.25f);
        EXPECT_EQ(table.Sample((Float(i) + 0.5f) / 4).index, i);
    }
}

}  // namespace
}  // namespace pbrt
