// Photon maps find what is near, and photon mapping makes the picture that paths from the camera make.
#include <gtest/gtest.h>

#include "pbrt/integrators/photon_map.h"
#include "pbrt/integrators/sppm_integrator.h"
#include "pbrt/math/rng.h"
#include "support/light_views.h"

namespace pbrt::test {
namespace {

TEST(PhotonMap, LookUpsMatchALinearSearch) {
    Rng rng(1);
    for (Float radius : {0.02f, 0.3f, 4.f}) {
        std::vector<std::vector<Photon>> groups(7);
        std::vector<Photon> all;
        for (std::vector<Photon> &group : groups)
            for (int i = 0; i < 300; ++i) {
                const Point2 a = rng.Uniform2();
                group.push_back({.p = {2 * a.x - 1, 2 * a.y - 1, rng.Uniform() / 10}, .scatterings = int(all.size())});
                all.push_back(group.back());
            }
        PhotonMap map;
        map.Build(groups, radius);
        ASSERT_EQ(map.Size(), all.size());
        size_t found = 0;
        for (int query = 0; query < 200; ++query) {
            const Point2 a = rng.Uniform2();
            const Point3 p{3 * a.x - 1.5f, 3 * a.y - 1.5f, 0.05f};
            std::vector<int> expected, numbers;
            for (const Photon &photon : all)
                if (LengthSquared(photon.p - p) <= radius * radius) expected.push_back(photon.scatterings);
            map.ForEachAround(p, [&](const Photon &photon) { numbers.push_back(photon.scatterings); });
            std::sort(numbers.begin(), numbers.end());
            EXPECT_EQ(numbers, expected);
            found += expected.size();
        }
        EXPECT_GT(found, 0u);
    }
    PhotonMap empty;
    std::vector<std::vector<Photon>> none(3);
    empty.Build(none, 1);
    empty.ForEachAround(Point3(0), [](const Photon &) { FAIL(); });
}

TEST(Sppm, RadiusShrinksAsPhotonsAreKept) {
    double square = 1;
    for (int i = 0; i < 500; ++i) {
        EXPECT_NEAR(double(SppmIntegrator::RelativeRadius(i)), std::sqrt(square), 1e-5) << i;
        square *= (i + 2.0 / 3) / (i + 1);
    }
}

/// Photons blur what they bring, so beside chance some of the mean is allowed.
constexpr double kBlur = 0.015;

class SppmViews : public testing::TestWithParam<View> {};

TEST_P(SppmViews, AgreeWithPath) {
    View view = GetParam();
    view.samples = 24;
    view.parameters = "'float radius' .106 'integer photonsperiteration' 1500";
    CheckMean(view, "sppm", 0.44, kBlur);
}

INSTANTIATE_TEST_SUITE_P(All, SppmViews,
                         testing::ValuesIn(ViewsNamed({"DiskAndBall", "Crop", "PointSpotAndDistant", "RoughMetal",
                                                       "Coat", "RoughGlass", "SmoothGlass", "ShadingNormals",
                                                       "DepthOne", "Mirror", "SkyAndGlass", "SkyOnly"})),
                         testing::PrintToStringParamName());

/// Most rays that leave the floor meet the dispersive pane after the photons on it were gathered.
TEST(Sppm, PhotonsThroughADispersivePaneCountOnce) {
    const auto mean = [](const std::string &eta) {
        const Objects objects = Objects()
                                    .Attribute("", Objects().AreaLight("4 4 4").Quad("-1 3 -1  1 3 -1  -1 3 1  1 3 1"))
                                    .Material("diffuse")
                                    .Quad("-2 -2 -2  2 -2 -2  -2 -2 2  2 -2 2")
                                    .Material("thindielectric", eta)
                                    .Quad("-20 0 -20  20 0 -20  -20 0 20  20 0 20");
        const std::string text = SceneText()
                                     .Film(8, 8)
                                     .Head("Sampler 'zsobol' 'integer pixelsamples' 64")
                                     .Integrator("sppm", 3, "'float radius' .3 'integer photonsperiteration' 2000")
                                     .LookAt("0 -1 3  0 -2 0  0 1 0")
                                     .Camera(40)
                                     .World(objects);
        return ChannelStatistics(RenderText(text).image).mean;
    };
    EXPECT_NEAR(mean("'spectrum eta' [ 300 1.5 900 1.5 ]") / mean("'float eta' 1.5"), 1, 0.15);
}

/// Direct light is found by any light sampler, the octree's learning one included.
TEST(Sppm, LightSamplersDoNotChangeTheMean) {
    View view = AllViews()[0];
    view.samples = 16;
    view.parameters = "'float radius' .111 'integer photonsperiteration' 3000";
    CheckLightSamplers(view, "sppm",
                       {"'string lightsampler' 'uniform'", "'string lightsampler' 'power'",
                        "'string lightsampler' 'octree' 'float octree.budget' .06"},
                       kBlur);
}

/// A panel that moves along its normal, in the light of a floor: photons at other times would miss it.
TEST(Sppm, PhotonsStayWithMovingSurfaces) {
    const auto mean = [](double start, double end) {
        const std::string panel = fmt::format(
            "ActiveTransform StartTime Translate 2.5 {} 0\n"
            "ActiveTransform EndTime Translate 2.5 {} 0\n"
            "ActiveTransform All Rotate 90 1 0 0",
            start, end);
        const std::string scene =
            SceneText()
                .LookAt("2.5 0.2 -3  2.5 1.4 0  0 1 0")
                .Camera(50)
                .Film(8, 8)
                .Samples(9)
                .Integrator("sppm", 2, "'float radius' 0.3 'integer photonsperiteration' 20000")
                .World(Objects()
                           .Light("spot", "'point3 from' [ 0 2.9 0 ] 'point3 to' [ 0 0 0 ] 'float coneangle' 40")
                           .Attribute("Rotate -90 1 0 0", Objects().Disk(4))
                           .Attribute(panel, Objects().Disk(0.8)));
        return ChannelStatistics(RenderText(scene).image).mean;
    };
    const double still = mean(1.5, 1.5);
    EXPECT_NEAR(mean(1, 2.5), still, 0.3 * still);
}

TEST(Sppm, IsTheSameForAnyNumberOfThreads) {
    View view = AllViews()[0];
    view.parameters = "'float radius' .15 'integer photonsperiteration' 20000";
    CheckThreads(view, "sppm", 5);
}

TEST(Sppm, SeedAndNumberOfPhotonsHaveDefaults) {
    View view = AllViews()[0];
    const auto pixel = [&](const std::string &parameters) {
        view.parameters = parameters;
        return RenderView(view, "sppm", 1, 2).Get({8, 12}, 0);
    };
    const Float unset = pixel("");
    EXPECT_EQ(unset, pixel("'integer seed' 0"));
    EXPECT_NE(unset, pixel("'integer seed' 1"));
    EXPECT_EQ(unset, pixel(fmt::format("'integer photonsperiteration' {}", kViewSize * kViewSize)));
    EXPECT_NE(unset, pixel("'integer photonsperiteration' 100"));
}

}  // namespace
}  // namespace pbrt::test
