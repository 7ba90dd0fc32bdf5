#include "ext/octree/prepass_effort.h"

#include <gtest/gtest.h>

namespace ext {

namespace {

PrepassEffort Render(size_t lights, size_t tries, double pixels, int samples) {
    PrepassEffort effort;
    effort.lights = lights;
    effort.triesPerVertex = tries;
    effort.pixels = pixels;
    effort.samplesPerPixel = samples;
    return effort;
}

}  // namespace

TEST(PrepassEffort, LongRendersSpendTheBudget) {
    EXPECT_DOUBLE_EQ(Render(10, 10, 512 * 512, 64).Share(), 0.01);
    EXPECT_DOUBLE_EQ(Render(200, 16, 512 * 512, 256).Share(), 0.01);
}

// Error times time by the model of the header, with b around the share that is spent.
TEST(PrepassEffort, ShortRendersOfManyLightsSpendTheShareOfLeastError) {
    const PrepassEffort effort = Render(200, 16, 160 * 120, 64);
    const double k = 55.0 * 200 / (2.0 * 160 * 120 * 64), b = effort.Share();
    EXPECT_GT(b, 0.01);
    auto error = [&](double share) { return (1 + k / share) * (1 + share); };
    EXPECT_LT(error(b), error(0.9 * b));
    EXPECT_LT(error(b), error(1.1 * b));
}

TEST(PrepassEffort, NoShortRenderSpendsMoreThanItsCap) {
    EXPECT_DOUBLE_EQ(Render(46, 46, 40 * 30, 1).Share(), 0.03);    // all lights are tried: three times the budget
    EXPECT_DOUBLE_EQ(Render(1000, 16, 40 * 30, 1).Share(), 0.15);  // drawn
    PrepassEffort wanted = Render(46, 46, 40 * 30, 1);
    wanted.budget = 0.5;
    EXPECT_DOUBLE_EQ(wanted.Share(), 1.5);
}

TEST(PrepassEffort, FirstVerticesAndLastTriesAreCounted) {
    // Between one and three times the budget: 2,000 vertices.
    const PrepassEffort few = Render(4, 4, 100 * 100, 32);
    EXPECT_GT(few.Share(), 0.01);
    EXPECT_LT(few.Share(), 0.03);
    EXPECT_NEAR(few.PathsPerPixel() * few.pixels, 2000, 1e-6);
    PrepassEffort huge = Render(64, 64, 4000.0 * 3000, 1024);
    huge.depth = 3;
    EXPECT_NEAR(huge.PathsPerPixel() * huge.pixels * huge.depth * 64, 4e6, 1);
}

}  // namespace ext
