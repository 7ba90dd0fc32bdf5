#include "pbrt/bxdfs/fresnel.h"
#include "support/errors.h"
#include "volume_scenes.h"

namespace pbrt::test {
namespace {

const Setting kUnderSky{.maxDepth = 20};

TEST(Subsurface, ALargePlaneReflectsWhatItsMatterDoes) {
    // Light comes from everywhere, and the plane is seen from above: Fresnel's share is mirrored, and of the rest the
    // matter sends back `reflectance`.
    for (double eta : {1.33, 1.6})
        for (double reflectance : {.3, .8}) {
            const std::string matter = fmt::format(
                "Material 'subsurface' 'spectrum reflectance' [300 {0} 900 {0}] 'spectrum mfp' [300 .05 900 .05]"
                " 'float eta' {1}\n",
                reflectance, eta);
            const RunningStatistics s = Green(kEvenSky + matter + "Shape 'disk' 'float radius' 20\n", kUnderSky);
            const double fresnel = double(FresnelDielectric(1, Float(eta)));
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
        const RunningStatistics s = Green(kEvenSky + material + matter + "\nShape 'sphere'", kUnderSky);
        EXPECT_LT(s.mean, 1 + 4 * s.StandardError() + .001) << matter;
        EXPECT_GT(s.mean, .6) << matter;  // the profile is that of a plane and loses some light on a ball
    }
}

TEST(Subsurface, OtherIntegratorsRenderADielectricWithAWarning) {
    const std::string light = "Translate 0 1.5 0 AreaLightSource 'diffuse' Shape 'sphere' 'float radius' .3";
    auto render = [&](const char *material, const char *integrator) {
        return RenderText(VolumeScene(kEvenSky + "Material " + material + " Shape 'sphere'\n" + light,
                                      {.integrator = integrator, .maxDepth = 20, .samples = 2}));
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
    ExpectSameForThreads(VolumeScene(Objects()
                                         .Add(kEvenSky)
                                         .Material("subsurface", "'float scale' 5 'float roughness' .2")
                                         .Sphere(.4)
                                         .AreaLight("9 5 1")
                                         .Add("Translate 0 1 0")
                                         .Sphere(.2),
                                     {.maxDepth = 20, .samples = 8}));
}

}  // namespace
}  // namespace pbrt::test
