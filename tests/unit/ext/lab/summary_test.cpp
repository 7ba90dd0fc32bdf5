#include "ext/lab/measures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "bias_simulation.h"

namespace ext::lab {

TEST(Summary, MatchesHandComputedValues) {
    const Summary s = Summarize(std::vector<double>{1, 2, 6});
    EXPECT_EQ(s.count, 3u);
    EXPECT_DOUBLE_EQ(s.mean, 3);
    EXPECT_DOUBLE_EQ(s.stdDev, std::sqrt(7.0));
    EXPECT_DOUBLE_EQ(s.standardError, std::sqrt(7.0 / 3));
    EXPECT_EQ(Summarize(std::vector<double>{5}).standardError, 0);
    EXPECT_EQ(Summarize({}).count, 0u);
}

TEST(FirefliesDecide, WhenTrimmingHalvesTheError) {
    EXPECT_TRUE(FirefliesDecide(1, 0.49));
    EXPECT_FALSE(FirefliesDecide(1, 0.5));
    EXPECT_TRUE(FirefliesDecide(1, 0));
    EXPECT_FALSE(FirefliesDecide(0, 0));
}

// a and b have the same distribution, so a may be called lower at most at the level of the test.
TEST(LowerBeyondNoise, KeepsItsLevel) {
    Rng rng(8, 8);
    const test::Noise noise = test::Lognormal(0.2);
    int alarms = 0, found = 0;
    const int trials = 4000;
    for (int i = 0; i < trials; ++i) {
        std::vector<double> a, b, far;
        for (int k = 0; k < 4; ++k) {
            a.push_back(noise(rng));
            b.push_back(noise(rng));
            far.push_back(2 * noise(rng));
        }
        alarms += LowerBeyondNoise(a, b);
        found += LowerBeyondNoise(a, far);
    }
    EXPECT_LE(alarms, 0.06 * trials);
    EXPECT_GE(alarms, 0.02 * trials);
    EXPECT_GE(found, 0.9 * trials);
}

TEST(LowerBeyondNoise, NeedsTwoRunsOfEach) {
    const std::vector<double> one = {1}, two = {9, 9.1}, low = {1, 1.1};
    EXPECT_FALSE(LowerBeyondNoise(one, two));
    EXPECT_TRUE(LowerBeyondNoise(low, two));
    EXPECT_FALSE(LowerBeyondNoise(two, low));
}

// Errors that both samplers have by the same fireflies of a seed cancel in the pairs, and the level is kept.
TEST(LowerBeyondNoise, ComparesSeedBySeed) {
    Rng rng(9, 8);
    const test::Noise shared = test::Lognormal(0.6), own = test::Lognormal(0.05);
    int alarms = 0, found = 0, foundOfUnequalNumber = 0;
    const int trials = 4000;
    for (int i = 0; i < trials; ++i) {
        std::vector<double> a, b, far;
        for (size_t k = 0; k < kSeedsToPair; ++k) {
            const double firefly = shared(rng);
            a.push_back(firefly * own(rng));
            b.push_back(firefly * own(rng));
            far.push_back(1.2 * firefly * own(rng));
        }
        alarms += LowerBeyondNoise(a, b);
        found += LowerBeyondNoise(a, far);
        foundOfUnequalNumber += LowerBeyondNoise(a, std::span(far).first(kSeedsToPair - 1));
    }
    EXPECT_LE(alarms, 0.06 * trials);
    EXPECT_GE(alarms, 0.02 * trials);
    EXPECT_GE(found, 0.9 * trials);
    EXPECT_LE(foundOfUnequalNumber, 0.3 * trials);
}

}  // namespace ext::lab
