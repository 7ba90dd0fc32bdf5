#include "pbrt/math/fast_functions.h"

#include <gtest/gtest.h>

#include <limits>

#include "pbrt/math/rng.h"

namespace pbrt {
namespace {

TEST(Trigonometry, EighthsOfATurnAreWithinTheirBound) {
    double sine = 0, cosine = 0;
    for (int i = -(1 << 22); i <= 1 << 22; ++i) {
        const Float x = Float(i) * 0x1p-22f;
        const SineCosine got = SineCosineOfEighth(x);
        const double angle = M_PI / 4 * double(x);
        if (i != 0) sine = std::max(sine, std::abs(double(got.sin) / std::sin(angle) - 1));
        cosine = std::max(cosine, std::abs(double(got.cos) - std::cos(angle)));
    }
    EXPECT_LT(sine, 1.5e-7);
    EXPECT_LT(cosine, 1e-7);
}

TEST(Trigonometry, TurnsAreWithinTheirBound) {
    double error = 0;
    for (int i = 0; i <= 1 << 23; ++i) {
        const Float u = Float(i) * 0x1p-23f;
        const SineCosine got = SineCosineOfTurn(u);
        const double angle = 2 * M_PI * double(u);
        error =
            std::max({error, std::abs(double(got.sin) - std::sin(angle)), std::abs(double(got.cos) - std::cos(angle))});
    }
    EXPECT_LT(error, 1e-7);
    for (Float u : {1e-20f, 1e-7f, 3e-5f}) EXPECT_NEAR(SineCosineOfTurn(u).sin / (2 * Pi * u), 1, 1e-6);
    EXPECT_EQ(SineCosineOfTurn(0).sin, 0);
    EXPECT_EQ(SineCosineOfTurn(0.25f).sin, 1);
    EXPECT_EQ(SineCosineOfTurn(0.5f).cos, -1);
    EXPECT_EQ(SineCosineOfTurn(1).cos, 1);
}

TEST(Trigonometry, ArcTangentIsWithinItsBound) {
    Rng rng(1);
    double error = 0;
    for (int i = 0; i < 4'000'000; ++i) {
        const Float y = std::exp2(40 * rng.Uniform() - 20) * rng.Uniform();
        const Float x = std::exp2(40 * rng.Uniform() - 20) * (rng.Uniform() - Float(0.5));
        const double wanted = std::atan2(double(y), double(x));
        if (wanted > 0) error = std::max(error, std::abs(double(ArcTangent2(y, x)) / wanted - 1));
    }
    EXPECT_LT(error, 3e-7);
    EXPECT_EQ(ArcTangent2(0, 0), 0);
    EXPECT_EQ(ArcTangent2(0, 2), 0);
    EXPECT_EQ(ArcTangent2(0, -2), Pi);
    EXPECT_NEAR(ArcTangent2(3, 0), Pi / 2, 1e-6);
}

TEST(Exponential, IsWithinItsBound) {
    double worst = 0;
    const auto check = [&](Float x) {
        const double exact = std::exp(-double(x));
        worst = std::max(worst, std::abs(double(ExpOfMinus(x)) / exact - 1));
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
        const Float u = std::max(rng.Uniform() * std::exp2(-Float(i % 32)), 0x1p-32f);
        const double exact = -std::log1p(-double(u));
        worst = std::max(worst, std::abs(double(DepthThatTakes(u)) / exact - 1));
    }
    EXPECT_LT(worst, 5e-7);
    EXPECT_EQ(DepthThatTakes(0), 0);
    EXPECT_TRUE(std::isfinite(DepthThatTakes(OneMinusEpsilon)));
}

}  // namespace
}  // namespace pbrt
