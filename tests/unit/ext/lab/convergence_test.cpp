#include "ext/lab/measures.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ext::lab {

namespace {
// A curve with error = scale / (cost - fixed).
ErrorCurve MonteCarlo(double scale, double fixed, std::initializer_list<double> costs) {
    std::vector<CurvePoint> points;
    for (double c : costs) points.push_back({c, scale / (c - fixed)});
    return ErrorCurve(points, fixed);
}
}  // namespace

TEST(ErrorCurve, ReadsPowerLawsExactlyBetweenThePoints) {
    for (double slope : {-1.0, -0.5, -2.0}) {
        std::vector<CurvePoint> points;
        for (double c : {1, 3, 4, 20}) points.push_back({c, 2 * std::pow(c, slope)});
        const ErrorCurve curve(points);
        for (double c : {1.0, 1.7, 3.0, 11.0, 20.0}) {
            const auto error = curve.ErrorAt(c);
            ASSERT_TRUE(error);
            EXPECT_NEAR(*error, 2 * std::pow(c, slope), 1e-12);
            EXPECT_NEAR(*curve.CostToReach(*error), c, 1e-9 * c);
        }
    }
}

TEST(ErrorCurve, ContinuesAtTheMonteCarloRateAfterPreparation) {
    const ErrorCurve curve = MonteCarlo(3, 5, {6, 8, 12});
    EXPECT_NEAR(*curve.ErrorAt(47), 3.0 / 42, 1e-12);
    EXPECT_NEAR(*curve.CostToReach(3.0 / 42), 47, 1e-9);
}

TEST(ErrorCurve, HasNoValueBeforeTheFirstPoint) {
    const ErrorCurve curve = MonteCarlo(1, 0, {2, 4});
    EXPECT_FALSE(curve.ErrorAt(1.9));
    EXPECT_FALSE(curve.CostToReach(0.6));
    EXPECT_EQ(*curve.CostToReach(0.5), 2);
    EXPECT_FALSE(curve.CostToReach(0));
    EXPECT_FALSE(ErrorCurve({}).ErrorAt(1));
    EXPECT_FALSE(ErrorCurve({{1, 0}, {NAN, 1}, {0, 1}, {2, INFINITY}}).CostToReach(1));
}

TEST(ErrorCurve, LevelsRisesToTheirGeometricMean) {
    const ErrorCurve curve({{8, 0.5}, {1, 4}, {2, 1}, {4, 4}});  // the errors of the middle two points rise
    ASSERT_EQ(curve.Points().size(), 4u);
    EXPECT_EQ(curve.Points()[0].error, 4);
    EXPECT_NEAR(curve.Points()[1].error, 2, 1e-12);
    EXPECT_NEAR(curve.Points()[2].error, 2, 1e-12);
    EXPECT_EQ(curve.Points()[3].error, 0.5);
    EXPECT_NEAR(*curve.CostToReach(2), 2, 1e-9);
    EXPECT_NEAR(*curve.ErrorAt(3), 2, 1e-12);
}

TEST(MeanCurve, AveragesPointByPointAsLongAsTheShortest) {
    const std::vector<std::vector<CurvePoint>> runs = {{{1, 4}, {2, 2}, {3, 1}}, {{3, 8}, {4, 4}}};
    const auto mean = MeanCurve(runs);
    ASSERT_EQ(mean.size(), 2u);
    EXPECT_EQ(mean[0].cost, 2);
    EXPECT_EQ(mean[0].error, 6);
    EXPECT_EQ(mean[1].cost, 3);
    EXPECT_EQ(mean[1].error, 3);
    EXPECT_TRUE(MeanCurve({}).empty());
}

TEST(SpeedUp, IsTheRatioOfTheConstantsOfTwoMonteCarloMeans) {
    const ErrorCurve fast = MonteCarlo(1, 0, {1, 2, 4, 8}), slow = MonteCarlo(5, 0, {1, 2, 4, 8});
    EXPECT_NEAR(*SpeedUpToEqualError(fast, slow), 5, 1e-9);
    EXPECT_NEAR(*SpeedUpToEqualError(slow, fast), 0.2, 1e-9);
    // The first error of this curve is below the last one of the other.
    const ErrorCurve best = MonteCarlo(0.01, 0, {1, 2, 4, 8});
    EXPECT_NEAR(*SpeedUpToEqualError(slow, best), 0.002, 1e-9);
    EXPECT_FALSE(SpeedUpToEqualError(fast, ErrorCurve({})));
}

// With preparation in the cost, the gain depends on the error that is compared: here the error at the end of the
// prepared curve, 1/4, costs 8 instead of 20.
TEST(SpeedUp, CountsPreparation) {
    const ErrorCurve prepared = MonteCarlo(1, 4, {5, 6, 8}), plain = MonteCarlo(5, 0, {1, 2, 4, 8});
    EXPECT_NEAR(*SpeedUpToEqualError(prepared, plain), 20.0 / 8, 1e-9);
}

TEST(ErrorRatio, ComparesAtTheLargestCommonCost) {
    const ErrorCurve a = MonteCarlo(1, 0, {1, 2, 4}), b = MonteCarlo(3, 0, {1, 8});
    EXPECT_NEAR(*ErrorRatioAtEqualCost(a, b), 1.0 / 3, 1e-9);
    EXPECT_NEAR(*ErrorRatioAtEqualCost(b, a), 3, 1e-9);
    EXPECT_FALSE(ErrorRatioAtEqualCost(a, MonteCarlo(1, 0, {5, 6})));
}

TEST(Efficiency, IsOneOverErrorTimesSeconds) {
    EXPECT_DOUBLE_EQ(Efficiency(0.02, 10), 5);
    EXPECT_EQ(Efficiency(0, 10), 0);
    EXPECT_EQ(Efficiency(1, 0), 0);
}

}  // namespace ext::lab
