#include <gtest/gtest.h>

#include <limits>

#include "pbrt/math/fast_functions.h"
#include "pbrt/math/rng.h"

namespace pbrt::test {
namespace {

TEST(Exponential, IsWithinItsBound) {
    double worst = 0;
    const auto check = [&](Float x) {
        const double exact = std::exp(-static_cast<double>(x));
        worst = std::max(worst, std::abs(static_cast<double>(ExpOfMinus(x)) / exact - 1));
    };
    for (Float x = 1e-12f; x < 86; x *= 1.00002f) check(x);
    Rng rng(3);
    for (int i = 0; i < 1000000; ++i) check(86 * rng.Uniform());
    EXPECT_LT(worst, 2e-7);
    EXPECT_EQ(ExpOfMinus(0), 1);
    EXPECT_EQ(ExpOfMinus(87), 0);
    EXPECT_EQ(ExpOfMinus(std::numeric_limits<Float>::infinity()), 0);
    EXPECT_GT(ExpOfMinus(86.5f), 0);
}

TEST(Exponential, DepthsAreWithinTheirBound) {
    double worst = 0;
    Rng rng(5);
    for (int i = 0; i < 1000000; ++i) {
        const Float u = std::max(rng.Uniform() * std::exp2(-static_cast<Float>(i % 32)), 0x1p-32f);
        const double exact = -std::log1p(-static_cast<double>(u));
        worst = std::max(worst, std::abs(static_cast<double>(DepthThatTakes(u)) / exact - 1));
    }
    EXPECT_LT(worst, 5e-7);
    EXPECT_EQ(DepthThatTakes(0), 0);
    EXPECT_TRUE(std::isfinite(DepthThatTakes(OneMinusEpsilon)));
}

}  // namespace
}  // namespace pbrt::test
