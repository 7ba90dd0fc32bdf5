#include <gtest/gtest.h>

#include "pbrt/bxdfs/fresnel.h"
#include "pbrt/core/parallel.h"
#include "support/errors.h"
#include "support/render_scene.h"
#include "support/scene_text.h"
#include "support/statistics.h"

namespace pbrt::test {
namespace {

/// A view of `world` under an even sky of radiance 1.
std::string SceneUnderSky(const std::string &world, const std::string &integrator = "volpath", int samples = 64) {
    return SceneText()
        .LookAt("0 0 3  0 0 0  0 1 0")
        .Camera("orthographic", "'float screenwindow' [-.5 .5 -.5 .5]")
        .Film(16, 16)
        .Filter("box")
        .Samples(samples)
        .Integrator(integrator, 20)
        .World(Objects().Sky("1 1 1").Add(world));
}

TEST(Subsurface, ALargePlaneReflectsWhatItsMatterDoes) {
    // Light comes from everywhere, and the plane is seen from above: Fresnel's share is mirrored, and of the rest the
    // matter sends back `reflectance`.
    for (double eta : {1.33, 1.6})
        for (double reflectance : {.3, .8}) {
            const std::string matter = fmt::format(
                "Material 'subsurface' 'spectrum reflectance' [300 {0} 900 {0}] 'spectrum mfp' [300 .05 900 .05]"
                " 'float eta' {1}\n",
                reflectance, eta);
            const RunningStatistics s =
                ChannelStatistics(RenderText(SceneUnderSky(matter + "Shape 'disk' 'float radius' 20\n")).image);
            const double fresnel = double(FresnelDielectric(1, static_cast<Float>(eta)));
            const double expected = fresnel + (1 - fresnel) * reflectance;
            EXPECT_LT(std::abs(s.mean - expected), 4 * s.StandardError() + .003 * expected)
                << "eta " << eta << " reflectance " << reflectance << ": " << s.mean << " for " << expected;
            EXPECT_LT(s.StandardError(), .01 * expected);
        }
}

TEST(Subsurface, NothingReflectsMoreThanComesIn) {
    for (const char *matter :
         {R"([300 .1 900 .1] "float eta" 1.05)", R"([300 .1 900 .1] "float eta" 1.8 "float roughness" .3)",
          R"([300 .05 900 .05] "float g" .8)", R"([300 .3 900 .3] "float g" -.7)"}) {
        const std::string material = "Material 'subsurface' 'spectrum reflectance' [300 1 900 1] 'spectrum mfp' ";
        const RunningStatistics s =
            ChannelStatistics(RenderText(SceneUnderSky(material + matter + "\nShape 'sphere'")).image);
        EXPECT_LT(s.mean, 1 + 4 * s.StandardError() + .001) << matter;
        EXPECT_GT(s.mean, .6) << matter;  // the profile is that of a plane and loses some light on a ball
    }
}

TEST(Subsurface, OtherIntegratorsSeeADielectricAndSaySo) {
    const std::string light = "Translate 0 1.5 0 AreaLightSource 'diffuse' Shape 'sphere' 'float radius' .3";
    auto render = [&](const char *material, const char *integrator) {
        return RenderText(
            SceneUnderSky(std::string("Material ") + material + " Shape 'sphere'\n" + light, integrator, 2));
    };
    const Rendered a = render(R"("subsurface" "float eta" 1.5 "float roughness" .1)", "path");
    const Rendered b = render(R"("dielectric" "float eta" 1.5 "float roughness" .1)", "path");
    EXPECT_TRUE(SameBits(a.image, b.image));
    ASSERT_EQ(a.diagnostics.size(), 1u);
    ExpectWords(a.diagnostics[0].message, {"\"volpath\""});
    EXPECT_TRUE(b.diagnostics.empty());
    EXPECT_TRUE(render(R"("subsurface")", "volpath").diagnostics.empty());
}

TEST(Subsurface, OneThreadAndTwoGiveTheSameBits) {
    const std::string text = SceneUnderSky(Objects()
                                               .Material("subsurface", "'float scale' 5 'float roughness' .2")
                                               .Sphere(.4)
                                               .AreaLight("9 5 1")
                                               .Add("Translate 0 1 0")
                                               .Sphere(.2),
                                           "volpath", 8);
    auto render = [&](int threads) {
        ThreadLimit limit(threads);
        return RenderText(text).image;
    };
    EXPECT_TRUE(SameBits(render(1), render(2)));
}

}  // namespace
}  // namespace pbrt::test
