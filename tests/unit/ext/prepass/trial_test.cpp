#include "ext/prepass/trial.h"

#include <gtest/gtest.h>

#include "pbrt/core/counters.h"
#include "support/build_text.h"
#include "support/scene_text.h"
#include "support/threads.h"

namespace ext {
namespace {

using pbrt::test::Objects, pbrt::test::OnThreads, pbrt::test::SceneText;

std::vector<TrialPixel> Pixels(double mean, double variance, size_t count = 400) {
    return std::vector<TrialPixel>(count,
                                   {.mean = mean, .variance = variance, .paths = 4, .vertices = 10, .shadowRays = 8});
}

TEST(CompareTrials, IsTheRatioOfErrorsAndOfCosts) {
    const std::vector<TrialPixel> option = Pixels(2, 1), alternative = Pixels(2, 4);
    const TrialRatio equalCost = CompareTrials(option, alternative, 0);
    EXPECT_TRUE(equalCost.WasTried());
    EXPECT_NEAR(equalCost.error, 0.25, 1e-12);
    EXPECT_NEAR(equalCost.cost, 1, 1e-12);
    EXPECT_NEAR(equalCost.Gain(), 4, 1e-12);
    // 14 units of cost, and one more for each of ten vertices.
    EXPECT_NEAR(CompareTrials(option, alternative, 1).cost, 24.0 / 14, 1e-12);
}

TEST(CompareTrials, IsRelativeToTheRadianceOfBothTrials) {
    // Variance counts where the image is dark; whichever trial found more light there, both are judged by one unit.
    std::vector<TrialPixel> option = Pixels(10, 1), alternative = Pixels(10, 1);
    for (size_t i = 0; i < 200; ++i) option[i] = {.mean = 0.9, .variance = 1, .paths = 4, .vertices = 10};
    for (size_t i = 0; i < 200; ++i) alternative[i] = {.mean = 1.1, .variance = 2, .paths = 4, .vertices = 10};
    const double mean = (10 + 1) / 2.0, dark = 1 + 0.01 * mean * mean, bright = 100 + 0.01 * mean * mean;
    EXPECT_NEAR(CompareTrials(option, alternative, 0).error, (1 / dark + 1 / bright) / (2 / dark + 1 / bright), 0.02);
}

TEST(CompareTrials, LeavesOutAFewOutliers) {
    std::vector<TrialPixel> option = Pixels(2, 1);
    option[123].variance = 1e9;
    EXPECT_NEAR(CompareTrials(option, Pixels(2, 1), 0).error, 1, 1e-12);
    for (size_t i = 0; i < 40; ++i) option[i].variance = 1e9;
    EXPECT_GT(CompareTrials(option, Pixels(2, 1), 0).error, 1e3);
}

TEST(CompareTrials, WithoutSamplesThereWasNoTrial) {
    EXPECT_FALSE(CompareTrials({}, {}, 0).WasTried());
    EXPECT_FALSE(CompareTrials(Pixels(1, 1), {}, 0).WasTried());
    EXPECT_FALSE(CompareTrials(Pixels(0, 0), Pixels(0, 0), 0).WasTried());
    EXPECT_EQ(TrialRatio().Gain(), 0);
}

TEST(TraceTrial, TracesPathsThatNothingElseCounts) {
    BuiltScene built = pbrt::test::BuildText(SceneText()
                                                 .LookAt("0 0 -4  0 0 0  0 1 0")
                                                 .Camera(50)
                                                 .Film(64, 64)
                                                 .Samples(64)
                                                 .Integrator("path")
                                                 .World(Objects().PointLight("0 2 -2", "1 1 1").Sphere(0.5)));
    Progress progress;
    PrepareContext context = built.Preparation(progress);
    EXPECT_FALSE(CanTrace(context)) << "the integrator offers no paths";
    context.tracePath = [](Point2i pixel, int sample, Sampler &sampler) {
        EXPECT_GT(sample, 1 << 30) << "a sample of the render may have this number";
        ++ThreadCounters().pathVertices;
        return double(pixel.x) + double(sampler.Get1D());
    };
    ASSERT_TRUE(CanTrace(context));
    const uint64_t before = SumCounters().pathVertices;
    const auto trace = [&] { return TraceTrial(context); };
    const std::vector<TrialPixel> expected = OnThreads(1, trace), again = OnThreads(3, trace);
    EXPECT_EQ(SumCounters().pathVertices, before);
    ASSERT_EQ(expected.size(), 256u);
    ASSERT_EQ(again.size(), expected.size());
    for (size_t i = 0; i < expected.size(); ++i) {
        EXPECT_EQ(expected[i].mean, again[i].mean);
        EXPECT_EQ(expected[i].variance, again[i].variance);
        EXPECT_EQ(expected[i].paths, 16);
        EXPECT_EQ(expected[i].vertices, 16);
    }
    context.samplesPerPixel = 16;
    EXPECT_FALSE(CanTrace(context)) << "a trial would take more than 3 % of the render's samples";
}

}  // namespace
}  // namespace ext
