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

TEST(LowerBeyondNoise, NeedsTwoRunsOfEach) {
    const std::vector<double> one = {1}, two = {9, 9.1}, low = {1, 1.1};
    EXPECT_FALSE(LowerBeyondNoise(one, two));
    EXPECT_TRUE(LowerBeyondNoise(low, two));
    EXPECT_FALSE(LowerBeyondNoise(two, low));
}

// a and b have the same distribution, so a may be called lower at most at the level of the test. Errors that samplers
// have by the same fireflies of a seed cancel in the pairs.
TEST(LowerBeyondNoise, KeepsItsLevelAndComparesSeedBySeed) {
    struct Case {
        uint64_t seed;
        test::Noise shared, own;
        size_t runs;
        double far;  ///< the errors of the worse sampler
    };
    for (const Case &k : {Case{8, [](Rng &) { return 1.0; }, test::Lognormal(0.2), 4, 2},
                          Case{9, test::Lognormal(0.6), test::Lognormal(0.05), kSeedsToPair, 1.2}}) {
        SCOPED_TRACE(k.seed);
        Rng rng(k.seed, 8);
        int alarms = 0, found = 0, foundOfUnequalNumber = 0;
        const int trials = 4000;
        for (int i = 0; i < trials; ++i) {
            std::vector<double> a, b, far;
            for (size_t s = 0; s < k.runs; ++s) {
                const double firefly = k.shared(rng);
                a.push_back(firefly * k.own(rng));
                b.push_back(firefly * k.own(rng));
                far.push_back(k.far * firefly * k.own(rng));
            }
            alarms += LowerBeyondNoise(a, b);
            found += LowerBeyondNoise(a, far);
            foundOfUnequalNumber += LowerBeyondNoise(a, std::span(far).first(k.runs - 1));
        }
        EXPECT_LE(alarms, 0.06 * trials);
        EXPECT_GE(alarms, 0.02 * trials);
        EXPECT_GE(found, 0.9 * trials);
        if (k.runs == kSeedsToPair) {
            EXPECT_LE(foundOfUnequalNumber, 0.3 * trials);
        }
    }
}

}  // namespace ext::lab
