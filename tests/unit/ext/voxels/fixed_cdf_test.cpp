#include <gtest/gtest.h>

#include <numeric>
#include <vector>

#include "ext/voxels/voxel_light_sampler.h"
#include "support/statistics.h"

namespace {

using namespace ext;
using pbrt::test::ChiSquareTest;

std::vector<uint32_t> Build(const std::vector<double> &weights) {
    std::vector<uint32_t> begins(weights.size());
    BuildFixedCdf(weights, begins);
    return begins;
}

TEST(FixedCdf, ProbabilitiesAreTheWeightsOverTheirSum) {
    std::vector<double> w = {3, 0.5, 0, 12, 1e-3, 1};
    std::vector<uint32_t> cdf = Build(w);
    double total = std::accumulate(w.begin(), w.end(), 0.0), sum = 0;
    for (uint32_t i = 0; i < w.size(); ++i) {
        auto p = double(FixedCdfPMF(cdf, i));
        EXPECT_NEAR(p, w[i] / total, 1e-7 * w[i] / total + 5e-9);
        EXPECT_GT(p, 0);
        sum += p;
    }
    EXPECT_NEAR(sum, 1, 1e-6);
}

TEST(FixedCdf, EqualSharesIfThereIsNoWeight) {
    std::vector<uint32_t> cdf = Build(std::vector<double>(7, 0.0));
    for (uint32_t i = 0; i < 7; ++i) EXPECT_NEAR(FixedCdfPMF(cdf, i), 1.f / 7, 1e-7f);
    EXPECT_EQ(FixedCdfPMF(Build({0.0}), 0), 1.f);
}

TEST(FixedCdf, NarrowEntriesBesideAWideOneKeepTheirProbability) {
    // A running sum in float, whose spacing near 1 is 6e-8, would lose these weights of 1e-8.
    std::vector<double> w(100000, 1e-8);
    w[0] = 1 - 99999e-8;
    std::vector<uint32_t> cdf = Build(w);
    for (uint32_t i = 1; i < w.size(); i += 997) EXPECT_NEAR(FixedCdfPMF(cdf, i), 1e-8f, 3e-10f);
}

TEST(FixedCdf, FrequenciesMatch) {
    std::vector<double> w = {3, 0.5, 0.01, 12, 0.2, 1, 1, 0.001};
    std::vector<uint32_t> cdf = Build(w);
    const int n = 200000;
    std::vector<double> observed(w.size()), expected(w.size());
    Rng rng(11);
    for (int i = 0; i < n; ++i) ++observed[SampleFixedCdf(cdf, rng.Uniform(), {1, 2, 3})];
    for (uint32_t i = 0; i < w.size(); ++i) expected[i] = double(FixedCdfPMF(cdf, i)) * n;
    EXPECT_GT(ChiSquareTest(observed, expected), 1e-4);
}

TEST(FixedCdf, EntriesNarrowerThanTheSpacingOfFloatsAreMetAsOftenAsTheyShould) {
    // The largest number stands for [1 - 2^-24, 1), the last 256 units. Four entries share them.
    std::vector<uint32_t> cdf = Build({0x1p26 - 4, 1, 1, 1, 1});
    const int n = 40000;
    std::vector<double> met(5), expected(5);
    for (int i = 0; i < n; ++i) ++met[SampleFixedCdf(cdf, OneMinusEpsilon, {Float(i), 0, 0})];
    for (size_t i = 0; i < 5; ++i) {
        double begin = std::max(double(cdf[i]), 0x1p32 - 256), end = i < 4 ? cdf[i + 1] : 0x1p32;
        expected[i] = n * std::max(0.0, end - begin) / 256;
    }
    EXPECT_GT(expected[4], n / 5);
    EXPECT_GT(ChiSquareTest(met, expected), 1e-4);
}

TEST(FixedCdf, EndsOfTheUnitInterval) {
    std::vector<uint32_t> cdf = Build({1, 2, 3});
    EXPECT_EQ(SampleFixedCdf(cdf, 0, {0, 0, 0}), 0u);
    EXPECT_EQ(SampleFixedCdf(cdf, OneMinusEpsilon, {0, 0, 0}), 2u);
    EXPECT_EQ(SampleFixedCdf(Build({5}), OneMinusEpsilon, {0, 0, 0}), 0u);
}

}  // namespace
