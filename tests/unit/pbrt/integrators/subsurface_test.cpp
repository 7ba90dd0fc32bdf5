#include <gtest/gtest.h>

#include <map>

#include "pbrt/bxdfs/fresnel.h"
#include "pbrt/core/parallel.h"
#include "pbrt/math/rng.h"
#include "support/build_text.h"
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

TEST(SampleCrossing, AllSurfacesOfTheMaterialAreEquallyLikely) {
    // Surfaces along x: a ball of material a, two panes of material b between, and an instance of a pane of material a.
    const BuiltScene built = BuildText(SceneUnderSky(Objects()
                                                         .Add("MakeNamedMaterial 'a' 'string type' 'subsurface'")
                                                         .Add("MakeNamedMaterial 'b' 'string type' 'diffuse'")
                                                         .Add("NamedMaterial 'a'")
                                                         .Sphere(1)
                                                         .Add("NamedMaterial 'b'")
                                                         .Attribute("Rotate 90 0 1 0", Objects().Disk(1))
                                                         .Triangles("1.5 -3 -3  1.5 3 -3  1.5 3 3  1.5 -3 3")
                                                         .Add("NamedMaterial 'a' ObjectBegin 'o'")
                                                         .Triangles("0 -3 -3  0 3 -3  0 3 3  0 -3 3")
                                                         .Add("ObjectEnd Translate 2 0 0 ObjectInstance 'o'")));
    const Scene &scene = *built.scene;
    // The origin of rendering space is the camera, which is at (0, 0, 3).
    auto at = [](Float x) { return Point3(x, .1f, .2f - 3); };
    Ray ray;
    ray.o = at(-5);
    ray.d = Vector3(1, 0, 0);
    const MaterialId a = scene.Intersect(ray)->material;
    std::map<int, double> counts;
    constexpr int n = 30000;
    Rng rng(1);
    for (int i = 0; i < n; ++i) {
        std::optional<Scene::Crossing> c = scene.SampleCrossing(at(-3), at(4), 0, a, rng.Uniform());
        ASSERT_TRUE(c);
        ASSERT_EQ(c->count, 3);
        EXPECT_EQ(c->point.material, a);
        ++counts[static_cast<int>(std::lround(c->point.p.x))];
    }
    std::vector<double> observed, expected(3, n / 3.);
    for (auto [x, count] : counts) observed.push_back(count);
    ASSERT_EQ(counts.size(), 3u);
    EXPECT_TRUE(counts.contains(-1) && counts.contains(1) && counts.contains(2));
    EXPECT_GT(ChiSquareTest(observed, expected), 1e-4);
    // Surfaces beyond the ends of the segment are not counted.
    EXPECT_EQ(scene.SampleCrossing(at(0), at(1.7f), 0, a, .3f)->count, 1);
    EXPECT_FALSE(scene.SampleCrossing(at(1.2f), at(1.7f), 0, a, .3f));
}

}  // namespace
}  // namespace pbrt::test
