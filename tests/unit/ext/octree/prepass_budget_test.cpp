#include "ext/octree/prepass_budget.h"

#include <gtest/gtest.h>

namespace ext {

namespace {

PrepassBudget Render(size_t lights, size_t tries, double pixels, int samples) {
    return {.lights = lights, .raysPerVertex = tries, .pixels = pixels, .samplesPerPixel = samples};
}

}  // namespace

TEST(PrepassBudget, LongRendersSpendTheBudget) {
    EXPECT_DOUBLE_EQ(Render(10, 10, 512 * 512, 64).Share(), 0.01);
    EXPECT_DOUBLE_EQ(Render(200, 16, 512 * 512, 256).Share(), 0.01);
}

TEST(PrepassBudget, ShortRendersToo) {
    EXPECT_DOUBLE_EQ(Render(1000, 8, 40 * 30, 1).Share(), 0.01);  // at each vertex 8 of 1000 lights are drawn
    // Every vertex tries all 46 lights.
    EXPECT_DOUBLE_EQ(Render(46, 46, 40 * 30, 1).Share(), 0.0125);
    PrepassBudget wanted = Render(46, 46, 40 * 30, 1);
    wanted.budget = 0.5;
    EXPECT_DOUBLE_EQ(wanted.Share(), 0.625);
}

TEST(PrepassBudget, TheMinimumAndTheMaximumHold) {
    // The minimum of 2,000 vertices costs between 1 and 1.25 times the budget.
    const PrepassBudget few = Render(4, 4, 100 * 100, 44);
    EXPECT_GT(few.Share(), 0.01);
    EXPECT_LT(few.Share(), 0.0125);
    EXPECT_NEAR(few.PathsPerPixel() * few.pixels, 2000, 1e-6);
    PrepassBudget huge = Render(64, 64, 4000.0 * 3000, 1024);
    huge.depth = 3;
    EXPECT_NEAR(huge.PathsPerPixel() * huge.pixels * huge.depth * 64, 4e6, 1);
}

}  // namespace ext
