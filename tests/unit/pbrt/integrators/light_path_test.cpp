// Paths from the lights, and paths from both sides, make the picture that paths from the camera make.
#include "pbrt/integrators/bdpt_path.h"
#include "pbrt/math/rng.h"
#include "pbrt/math/warps.h"
#include "pbrt/transport/path_walk.h"
#include "support/build_text.h"
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

/// Strips that turn to the ray are the same from both ends, on opposite sides of their middle. Power scattered into a
/// solid angle is radiance times the strip's width in projection, the same for all rays, and the sine to its axis.
TEST(LightPath, CurvesScatterAlikeFromBothEnds) {
    const Vector3 along = Normalize(Vector3(1, 0.3f, 0.2f));
    const std::string curve = "'float width' .2 'point3 P' [ -3 -.9 4.4  -1 -.3 4.8  1 .3 5.2  3 .9 5.6 ]";
    for (const char *type : {"flat", "cylinder"})
        for (const char *material : {"'diffuse'", "'conductor' 'float roughness' .4", "'hair' 'float alpha' 9"}) {
            SampledWavelengths lambda = SampledWavelengths::SampleVisible(0.5f);
            const BuiltScene built =
                BuildText(SceneText().InWorldSpace().Camera(40).Film(8, 8).Integrator("bdpt").World(
                    fmt::format("Material {}\nShape 'curve' 'string type' '{}' {}\n", material, type, curve)));
            const PathContext context{*built.scene, *built.camera, 1, true};
            const auto hit = [&](const Vector3 &w, Float side) {
                const Point3 start = Point3(0, 0, 5) + w * Float(2) + Normalize(Cross(along, w)) * side;
                PathWalk walk(context, Ray{.o = start, .d = -w});
                EXPECT_EQ(walk.Next(), PathWalk::Met::Surface);
                EXPECT_TRUE(walk.FindScattering(lambda));
                BdptVertex vertex;
                vertex.surface = walk.Vertex();
                return vertex;
            };
            Rng rng(1);
            for (int i = 0; i < 50; ++i) {
                const Vector3 wo = SampleUniformSphere(rng.Uniform2()), wi = SampleUniformSphere(rng.Uniform2());
                const Float sineO = Length(Cross(wo, along)), sineI = Length(Cross(wi, along));
                if (std::min(sineO, sineI) < 0.3f) continue;
                const Float side = 0.08f * (2 * rng.Uniform() - 1);
                const BdptVertex fromLight = hit(wo, side), fromCamera = hit(wi, -side);
                const Float light = fromLight.F(wi, TransportMode::Importance)[0] * fromLight.CosineOfLight(wi) * sineO;
                const Float camera = fromCamera.F(wo)[0] * fromCamera.Cosine(wo) * sineI;
                EXPECT_NEAR(light, camera, 2e-3f * camera + 1e-5f) << type << ' ' << material << ' ' << i;
                for (const Vector3 &w : {wo, wi})
                    EXPECT_NEAR(fromLight.AreaPdfOfParallel(1, w), fromCamera.AreaPdfOfParallel(1, w), 1e-4f);
                const Float density = fromCamera.ScatterPdf(wo, wi, TransportMode::Importance);
                EXPECT_NEAR(fromLight.ScatterPdf(wo, wi, TransportMode::Importance), density, 2e-3f * density + 1e-5f);
            }
        }
}

TEST(LightPath, NeedsACameraThatItCanReach) {
    const View view{.name = "realistic", .camera = kRealisticCamera, .objects = AllViews()[0].objects};
    ExpectError([&] { RenderView(view, "lightpath", 1, 1); }, {"perspective", "orthographic", "spherical"});
}

}  // namespace
}  // namespace pbrt::test
