// Paths from the lights, and paths from both sides, make the picture that paths from the camera make.
#include "support/errors.h"
#include "support/light_views.h"

namespace pbrt::test {
namespace {

std::vector<View> ViewsOfAllKinds() {
    std::vector<View> all = AllViews();
    all.insert(all.end(), FoggyViews().begin(), FoggyViews().end());
    return all;
}

class LightPathViews : public testing::TestWithParam<View> {};

TEST_P(LightPathViews, AgreeWithPath) {
    if (!GetParam().isForLightPath) GTEST_SKIP() << "not for light paths";
    // 48 numbers a view, 19 views: chance fails one of some 15 runs of all.
    View view = GetParam();
    view.samples = 40;
    CheckMean(view, "lightpath", 0.33);
}

TEST_P(LightPathViews, BidirectionalPathsAgreeWithPath) { CheckMean(GetParam(), "bdpt", 0.44); }

INSTANTIATE_TEST_SUITE_P(All, LightPathViews, testing::ValuesIn(ViewsOfAllKinds()), testing::PrintToStringParamName());

/// The weights use the probabilities of any light sampler, the octree's learning one and its portals included.
TEST(Bdpt, LightSamplersDoNotChangeTheMean) {
    View view = AllViews()[0];
    view.samples = 16;
    CheckLightSamplers(view, "bdpt");
}

TEST(LightPath, IsTheSameForAnyNumberOfThreads) {
    for (const char *integrator : {"lightpath", "bdpt"})
        for (const View &view : {AllViews()[0], FoggyViews()[0], FoggyViews()[2]}) CheckThreads(view, integrator, 16);
}

TEST(LightPath, LightsWithoutVisibleGeometryAreNotSeen) {
    const std::string scene = SceneText()
                                  .LookAt("0 0 -5  0 0 0  0 1 0")
                                  .Camera(40)
                                  .Film(4, 4)
                                  .Samples(8)
                                  .Integrator("lightpath", 0)
                                  .World(Objects()
                                             .Attribute("Translate 0 0 -9", Objects().Disk(1))
                                             .AreaLight("5 5 5")
                                             .Shape("sphere", "'float alpha' 0"));
    EXPECT_EQ(ChannelStatistics(RenderText(scene).image).mean, 0);
}

TEST(LightPath, NeedsACameraThatItCanReach) {
    const View view{.name = "realistic", .camera = kRealisticCamera, .objects = AllViews()[0].objects};
    ExpectError([&] { RenderView(view, "lightpath", 1, 1); }, {"perspective", "orthographic", "spherical"});
}

}  // namespace
}  // namespace pbrt::test
