// Paths from the lights, and paths from both sides, make the picture that paths from the camera make.
#include <gtest/gtest.h>

#include "pbrt/core/parallel.h"
#include "support/light_views.h"
#include "support/statistics.h"

namespace pbrt::test {
namespace {

class LightPathViews : public testing::TestWithParam<View> {};

TEST_P(LightPathViews, AgreeWithPath) {
    if (!GetParam().isForLightPath) GTEST_SKIP() << "light that only camera paths see";
    double noise = 1;
    // 48 numbers a view, 12 views: chance goes beyond 5.5 with 14 degrees of freedom in one of some 25 runs of all.
    EXPECT_LT(LargestDistance(GetParam(), "lightpath", &noise), 5.5);
    EXPECT_LT(noise, 0.06) << "the test would see nothing";
}

TEST_P(LightPathViews, BidirectionalPathsAgreeWithPath) {
    double noise = 1;
    View view = GetParam();
    view.samples /= 2;
    EXPECT_LT(LargestDistance(view, "bdpt", &noise), 5.5);
    EXPECT_LT(noise, 0.08) << "the test would see nothing";
}

INSTANTIATE_TEST_SUITE_P(All, LightPathViews, testing::ValuesIn(AllViews()),
                         [](const auto &test) { return test.param.name; });

/// The weights know with which probability any light sampler chooses a light, the octree's learning one and its tiles
/// of the sky included, and any gate may thin out shadow rays.
TEST(Bdpt, LightSamplersAndGatesDoNotChangeTheMean) {
    View view = AllViews()[0];
    view.samples = 128;
    view.objects +=
        "LightSource \"point\" \"point3 from\" [ 1 -1 1.5 ] \"rgb I\" [ .5 1 1.5 ]\n"
        "LightSource \"infinite\" \"rgb L\" [ .2 .2 .3 ]\n";
    int tested = 0;
    for (const char *lights :
         {"\"string lightsampler\" \"uniform\"", "\"string lightsampler\" \"bvh\"",
          "\"string lightsampler\" \"octree\"", "\"string lightsampler\" \"octree\" \"float octree.opensky\" 1",
          "\"string shadowgate\" \"neepp\""}) {
        view.parameters = lights;
        try {
            RenderView(view, "bdpt", 1, 1);
        } catch (const UserError &) {
            continue;  // a build without extensions
        }
        ++tested;
        double noise = 1;
        EXPECT_LT(LargestDistance(view, "bdpt", &noise), 5.5) << lights;
        EXPECT_LT(noise, 0.05) << lights;
    }
    EXPECT_GE(tested, 2);
}

TEST(LightPath, IsTheSameForAnyNumberOfThreads) {
    const View view = AllViews()[0];
    for (const char *integrator : {"lightpath", "bdpt"}) {
        ThreadLimit one(1);
        const Image expected = RenderView(view, integrator, 1, 16);
        for (int threads : {2, 5}) {
            ThreadLimit limit(threads);
            const Image image = RenderView(view, integrator, 1, 16);
            for (int y = 0; y < kViewSize; ++y)
                for (int x = 0; x < kViewSize; ++x) EXPECT_EQ(image.Get({x, y}, 0), expected.Get({x, y}, 0));
        }
    }
}

TEST(LightPath, NeedsACameraThatItCanReach) {
    const View view{.name = "spherical", .camera = "Camera \"spherical\"\n", .objects = AllViews()[0].objects};
    try {
        RenderView(view, "lightpath", 1, 1);
        FAIL() << "a picture";
    } catch (const UserError &e) {
        EXPECT_NE(std::string(e.what()).find("\"perspective\" and \"orthographic\""), std::string::npos) << e.what();
    }
}

}  // namespace
}  // namespace pbrt::test
