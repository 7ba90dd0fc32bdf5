#include "pbrt/math/statistics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/statistics.h"

namespace pbrt {

// Two-sided critical values from the usual tables.
TEST(StudentT, MatchesTables) {
    EXPECT_NEAR(StudentTwoSidedP(12.706, 1), 0.05, 1e-5);
    EXPECT_NEAR(StudentTwoSidedP(4.303, 2), 0.05, 1e-5);
    EXPECT_NEAR(StudentTwoSidedP(-2.228, 10), 0.05, 1e-4);
    EXPECT_NEAR(StudentTwoSidedP(2.750, 30), 0.01, 1e-4);
    EXPECT_NEAR(StudentCritical(0.01, 5), 4.032, 1e-3);
    // One degree of freedom is the Cauchy distribution.
    for (double t : {0.3, 2.0, 500.0})
        EXPECT_NEAR(StudentTwoSidedP(t, 1), 1 - 2 * std::atan(t) / 3.141592653589793, 1e-12);
}

TEST(StudentT, CriticalInvertsP) {
    for (double dof : {0.5, 1.0, 2.7, 40.0, 1e12})
        for (double p : {0.9, 0.05, 1e-5, 1e-9})
            EXPECT_NEAR(StudentTwoSidedP(StudentCritical(p, dof), dof) / p, 1, 1e-6) << dof << " " << p;
}

TEST(StudentT, TendsToTheNormal) {
    auto normalP = [](double z) { return std::erfc(std::abs(z) / std::sqrt(2.0)); };
    for (double z : {0.5, 2.0, 4.0}) EXPECT_NEAR(StudentTwoSidedP(z, 1e9) / normalP(z), 1, 1e-6);
    for (double p : {0.3, 1e-6}) EXPECT_NEAR(normalP(NormalCritical(p)) / p, 1, 1e-9);
}

TEST(StudentT, EndsAreDefined) {
    EXPECT_EQ(StudentTwoSidedP(INFINITY, 3), 0);
    EXPECT_EQ(StudentTwoSidedP(NAN, 3), 1);
    EXPECT_EQ(StudentTwoSidedP(5, 0), 1);
    EXPECT_EQ(StudentTwoSidedP(0, 3), 1);
    EXPECT_TRUE(std::isinf(StudentCritical(0.1, 0)));
    EXPECT_TRUE(std::isinf(StudentCritical(0, 3)));
    EXPECT_EQ(StudentCritical(1, 3), 0);
    EXPECT_TRUE(std::isinf(NormalCritical(0)));
    EXPECT_GE(StudentTwoSidedP(1e200, 1e5), 0);
}

TEST(Sidak, LevelAndPAreInverse) {
    EXPECT_NEAR(SidakLevel(0.05, 1), 0.05, 1e-15);
    EXPECT_NEAR(SidakP(SidakLevel(0.01, 900), 900), 0.01, 1e-12);
    EXPECT_NEAR(SidakLevel(1e-12, 1000), 1e-15, 1e-20);
    EXPECT_EQ(SidakP(1, 7), 1);
}

TEST(RunningMoments, MatchHandComputedValues) {
    RunningMoments m;
    EXPECT_EQ(m.Variance(), 0);
    for (double x : {1e9 + 1, 1e9 + 2, 1e9 + 6}) m.Add(x);
    EXPECT_EQ(m.Count(), 3u);
    EXPECT_DOUBLE_EQ(m.Mean(), 1e9 + 3);
    EXPECT_NEAR(m.Variance(), 7, 1e-6);
}

// The tail probability that the tests use, against the usual tables.
TEST(ChiSquareTail, MatchesTables) {
    EXPECT_NEAR(test::ChiSquareTail(3.841, 1), 0.05, 1e-4);
    EXPECT_NEAR(test::ChiSquareTail(18.307, 10), 0.05, 1e-5);
    EXPECT_NEAR(test::ChiSquareTail(135.807, 100), 0.01, 1e-5);
    // Exponential for two degrees of freedom.
    EXPECT_NEAR(test::ChiSquareTail(9.21034, 2), std::exp(-9.21034 / 2), 1e-12);
    EXPECT_EQ(test::ChiSquareTail(0, 3), 1);
    EXPECT_EQ(test::ChiSquareTail(5, 0), 1);
    EXPECT_EQ(test::ChiSquareTail(INFINITY, 3), 0);
    EXPECT_TRUE(std::isnan(test::ChiSquareTail(NAN, 3))) << "NaN must not pass as agreement";
}

}  // namespace pbrt
