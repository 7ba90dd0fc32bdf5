#include "pbrt/math/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "pbrt/math/rng.h"
#include "support/statistics.h"

namespace pbrt {
namespace {

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

/// Products of two floats of either sign, over a range of 2^40.
std::vector<double> Products(size_t count) {
    Rng rng(5);
    std::vector<double> products;
    for (size_t i = 0; i < count; ++i) {
        const Float size = std::exp2(20 * rng.Uniform() - 10), weight = std::exp2(20 * rng.Uniform() - 10);
        products.push_back((rng.Uniform() < 0.4f ? -1 : 1) * double(size) * double(weight));
    }
    return products;
}

TEST(PreciseSum, IsTheSameInAnyOrderAndAnyPartsToTheBit) {
    std::vector<double> addends = Products(1000);
    PreciseSum whole;
    double plain = 0;
    for (double x : addends) {
        whole.Add(x);
        plain += x;
    }
    Rng rng(9);
    int plainDiffers = 0;
    for (int round = 0; round < 200; ++round) {
        for (size_t i = addends.size(); i-- > 1;) std::swap(addends[i], addends[rng.UniformInt(uint32_t(i + 1))]);
        // Three parts, summed separately and added in any order.
        const size_t a = rng.UniformInt(1000), b = a + rng.UniformInt(uint32_t(1000 - a));
        PreciseSum parts[3], sum;
        double plainParts[3] = {};
        for (size_t i = 0; i < addends.size(); ++i) {
            const size_t part = i < a ? 0 : i < b ? 1 : 2;
            parts[part].Add(addends[i]);
            plainParts[part] += addends[i];
        }
        for (size_t k : {2, 0, 1}) sum += parts[k];
        EXPECT_EQ(sum.Value(), whole.Value());
        EXPECT_EQ(sum.Rest(), whole.Rest());
        plainDiffers += plainParts[2] + plainParts[0] + plainParts[1] != plain;
    }
    EXPECT_GT(plainDiffers, 100) << "plain sums would have done";
}

TEST(PreciseSum, KeepsWhatADoubleLoses) {
    PreciseSum sum;
    sum.Add(1e16);
    for (int i = 0; i < 1000; ++i) sum.Add(1);
    sum.Add(-1e16);
    EXPECT_EQ(sum.Value(), 1000);
    EXPECT_EQ(sum.Rest(), 0);
    PreciseSum infinite;
    infinite.Add(1);
    infinite.Add(HUGE_VAL);
    infinite.Add(1);
    EXPECT_EQ(infinite.Value(), HUGE_VAL);
}

TEST(PreciseSum, TheVarianceOfEqualNumbersIsZero) {
    for (double x : {0.1f, 123.456f, 3e-5f}) {
        PreciseSum sum, squares;
        for (int n = 1; n <= 5000; ++n) {
            sum.Add(x);
            squares.Add(x * x);
            ASSERT_EQ(VarianceOf(sum, squares, n), 0) << x << " " << n;
        }
    }
    PreciseSum sum, squares;
    for (double x : {1.0, 2.0, 4.0}) {
        sum.Add(x);
        squares.Add(x * x);
    }
    EXPECT_NEAR(VarianceOf(sum, squares, 3), 7.0 / 3, 1e-15);
    EXPECT_EQ(VarianceOf(sum, squares, 1), 0);
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

}  // namespace
}  // namespace pbrt
