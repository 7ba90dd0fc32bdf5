#include "pbrt/math/catmull_rom.h"

#include <gtest/gtest.h>

#include <vector>

#include "pbrt/math/rng.h"
#include "support/statistics.h"

namespace pbrt {
namespace {

const std::vector<Float> kNodes = {0, .1f, .5f, .6f, 1.4f, 2, 5};
const std::vector<Float> kBumpy = {.2f, 1, .8f, 2, .5f, .4f, 1.1f};
const std::vector<Float> kGrowing = {.1f, .2f, .9f, 1, 1.3f, 2, 6};

/// The reference: the spline as a weighted sum of its values.
Float Value(const std::vector<Float> &values, Float x) {
    std::optional<SplineWeights> w = CatmullRomWeights(kNodes, x);
    Float sum = 0;
    for (size_t k = 0; k < 4; ++k) sum += w->w[k] * values[size_t(w->first) + k];
    return sum;
}

double Integral(const std::vector<Float> &values, Float a, Float b) {
    constexpr int n = 4000;
    double sum = 0;
    for (int i = 0; i < n; ++i) sum += double(Value(values, a + (b - a) * (Float(i) + .5f) / n));
    return sum * double(b - a) / n;
}

TEST(CatmullRom, PassesThroughItsPoints) {
    for (size_t i = 0; i < kNodes.size(); ++i) EXPECT_NEAR(Value(kBumpy, kNodes[i]), kBumpy[i], 1e-6f);
    for (size_t i = 0; i + 1 < kNodes.size(); ++i) {
        const SplinePiece piece = CatmullRomPiece(kNodes, int(i), [&](int k) { return kBumpy[size_t(k)]; });
        for (Float t : {0.f, .3f, .77f, 1.f})
            EXPECT_NEAR(piece.Value(t), Value(kBumpy, piece.x + t * piece.width), 1e-5f);
    }
}

TEST(CatmullRom, StraightLinesStayStraight) {
    std::vector<Float> line;
    for (Float x : kNodes) line.push_back(3 - 2 * x);
    for (Float x = 0; x < 5; x += .07f) EXPECT_NEAR(Value(line, x), 3 - 2 * x, 1e-5f);
}

TEST(CatmullRom, SlopesAreContinuous) {
    for (size_t i = 1; i + 1 < kNodes.size(); ++i) {
        const Float h = 2e-4f, x = kNodes[i];
        const Float left = (Value(kBumpy, x) - Value(kBumpy, x - h)) / h;
        const Float right = (Value(kBumpy, x + h) - Value(kBumpy, x)) / h;
        const Float chord = (kBumpy[i + 1] - kBumpy[i - 1]) / (kNodes[i + 1] - kNodes[i - 1]);
        EXPECT_NEAR(left, chord, .1f) << i;
        EXPECT_NEAR(right, chord, .1f) << i;
    }
}

TEST(CatmullRom, NothingOutsideTheNodes) {
    EXPECT_FALSE(CatmullRomWeights(kNodes, -1e-3f));
    EXPECT_FALSE(CatmullRomWeights(kNodes, 5.01f));
    EXPECT_FALSE(CatmullRomWeights(kNodes, NAN));
}

TEST(CatmullRom, RunningIntegral) {
    std::vector<Float> cdf(kNodes.size());
    const Float whole = IntegrateCatmullRom(kNodes, kBumpy, cdf);
    EXPECT_EQ(whole, cdf.back());
    for (size_t i = 0; i < kNodes.size(); ++i) EXPECT_NEAR(double(cdf[i]), Integral(kBumpy, 0, kNodes[i]), 1e-4);
}

TEST(CatmullRom, InverseUndoesTheSpline) {
    for (Float x = 0; x <= 5; x += .037f)
        EXPECT_NEAR(Value(kGrowing, InvertCatmullRom(kNodes, kGrowing, Value(kGrowing, x))), Value(kGrowing, x), 1e-5f)
            << x;
    EXPECT_EQ(InvertCatmullRom(kNodes, kGrowing, 0), kNodes.front());
    EXPECT_EQ(InvertCatmullRom(kNodes, kGrowing, 9), kNodes.back());
}

TEST(CatmullRom, SamplesFollowTheSpline) {
    std::vector<Float> cdf(kNodes.size());
    const double whole = double(IntegrateCatmullRom(kNodes, kBumpy, cdf));
    constexpr int cells = 50, n = 100000;
    std::vector<double> observed(cells), expected(cells);
    Rng rng(7);
    for (int i = 0; i < n; ++i) {
        const Float x = SampleCatmullRom(
            std::span<const Float>(kNodes), [&](int k) { return kBumpy[size_t(k)]; },
            [&](int k) { return cdf[size_t(k)]; }, rng.Uniform());
        ++observed[std::min<size_t>(cells - 1, size_t(x * (cells / 5.f)))];
    }
    for (int i = 0; i < cells; ++i)
        expected[size_t(i)] = n * Integral(kBumpy, Float(i) * 5 / cells, Float(i + 1) * 5 / cells) / whole;
    EXPECT_GT(test::ChiSquareTest(observed, expected), 1e-4);
}

}  // namespace
}  // namespace pbrt
