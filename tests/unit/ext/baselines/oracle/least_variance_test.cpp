#include <gtest/gtest.h>

#include <numeric>
#include <vector>

#include "pbrt/math/rng.h"
#include "second_moment.h"

namespace {

using namespace ext;

TEST(LeastVariance, WithoutBsdfSamplingIsTheRootOfTheSecondMoment) {
    // The second moments are 4, 2 and 0.
    std::vector<LightPoint> points = {{2, 0}, {2, 0}, {0, 0}, {2, 0}, {0, 0}, {0, 0}};
    std::vector<double> pmf(3);
    ASSERT_TRUE(MinVariancePmf(points, pmf));
    double sum = 2 + std::sqrt(2.0);
    EXPECT_NEAR(pmf[0], 2 / sum, 1e-12);
    EXPECT_NEAR(pmf[1], std::sqrt(2.0) / sum, 1e-12);
    EXPECT_EQ(pmf[2], 0);
    EXPECT_NEAR(SecondMoment(points, pmf), sum * sum, 1e-12);
}

TEST(LeastVariance, WithoutVisibleLightReturnsFalse) {
    std::vector<LightPoint> points(6);
    std::vector<double> pmf = {1, 2, 3};
    EXPECT_FALSE(MinVariancePmf(points, pmf));
    EXPECT_EQ(pmf, (std::vector<double>{1, 2, 3}));
}

/// Lights of very different strengths, partly visible, some easy for BSDF sampling.
std::vector<LightPoint> RandomLights(Rng &rng, size_t lights, size_t perLight) {
    std::vector<LightPoint> points;
    for (size_t l = 0; l < lights; ++l) {
        Float strength = std::pow(Float(10), 3 * rng.Uniform()), seen = rng.Uniform();
        bool findable = rng.Uniform() < 0.7f;
        Float ratio = std::pow(Float(10), 4 * rng.Uniform() - 3);
        for (size_t i = 0; i < perLight; ++i) {
            LightPoint y;
            if (rng.Uniform() < seen)
                y = {strength * (Float(0.5) + rng.Uniform()), findable ? ratio * (Float(0.5) + rng.Uniform()) : 0};
            points.push_back(y);
        }
    }
    return points;
}

TEST(LeastVariance, TwoLightsAreAtTheMinimumOfAScan) {
    Rng rng(3);
    int worse = 0;
    for (int trial = 0; trial < 200; ++trial) {
        std::vector<LightPoint> points = RandomLights(rng, 2, 8);
        std::vector<double> pmf(2);
        if (!MinVariancePmf(points, pmf)) continue;
        EXPECT_NEAR(pmf[0] + pmf[1], 1, 1e-12);
        double least = std::numeric_limits<double>::infinity();
        for (int i = 1; i < 2000; ++i) {
            double p[2] = {i / 2000.0, 1 - i / 2000.0};
            least = std::min(least, SecondMoment(points, p));
        }
        double ratio = SecondMoment(points, pmf) / least;
        EXPECT_LE(ratio, 1.1) << "trial " << trial << " pmf " << pmf[0];
        worse += ratio > 1.001;
    }
    // There can be two local minima; the search finds the one nearer to the square roots of the second moments.
    EXPECT_LE(worse, 5);
}

TEST(LeastVariance, NoOtherProbabilitiesAreBetter) {
    Rng rng(4);
    for (int trial = 0; trial < 50; ++trial) {
        std::vector<LightPoint> points = RandomLights(rng, 10, 4);
        std::vector<double> pmf(10);
        if (!MinVariancePmf(points, pmf)) continue;
        EXPECT_NEAR(std::accumulate(pmf.begin(), pmf.end(), 0.0), 1, 1e-12);
        double here = SecondMoment(points, pmf);
        for (int step = 0; step < 200; ++step) {
            // Other probabilities, some near to the minimum and some far from it.
            std::vector<double> other = pmf;
            double sum = 0;
            Float size = std::pow(Float(10), -2 * rng.Uniform());
            for (double &p : other) {
                p = std::max(p, 1e-6) * std::exp(double(size * (2 * rng.Uniform() - 1)));
                sum += p;
            }
            for (double &p : other) p /= sum;
            EXPECT_GE(SecondMoment(points, other), here * 0.995) << "trial " << trial;
        }
    }
}

}  // namespace
