// Opaque housings around lights let no light out and caps on lenses let none in, however small they are for the
// distance.
#include <gtest/gtest.h>

#include "placed_scene.h"

namespace pbrt::test {
namespace {

/// Floor 150 units below the origin.
std::string DistantFloorText(const Placement &at, const ScaleIntegrator &integrator, const Objects &light,
                             const Objects &housing) {
    return ViewText(at, integrator, {0, -149, 5, 0, -150, 0, 0, 1, 0}, 60, 3,
                    Objects()
                        .Diffuse(".5 .5 .5")
                        .Add(light)
                        .Add(housing)
                        .Quad(at.Points({-50, -150, -50, 50, -150, -50, -50, -150, 50, 50, -150, 50})));
}

struct Part {
    const char *name;
    Objects (*objects)(const Placement &);
};

Objects Area(const Objects &shape, const std::string &before = "") {
    return Objects().Attribute(before, Objects().AreaLight("1e9 1e9 1e9", "'bool twosided' true").Add(shape));
}
const Part kLights[] = {
    {"point", [](const Placement &at) { return Objects().Light("point", "'rgb I' [ " + at.Intensity(1e5) + " ]"); }},
    {"ball", [](const Placement &at) { return Area(Objects().Sphere(.003 * at.scale)); }},
    {"cylinder",
     [](const Placement &at) {
         return Area(Objects().Shape(
             "cylinder", fmt::format("'float radius' {0} 'float zmin' -{0} 'float zmax' {0}", at.Length(.002))));
     }},
    {"disk", [](const Placement &at) { return Area(Objects().Disk(.003 * at.scale), "Rotate 70 1 0 0"); }},
    {"triangle",
     [](const Placement &at) {
         return Area(Objects().Triangles(at.Points({-.002, .001, -.002, .002, 0, -.001, 0, .001, .003}), "0 1 2"));
     }},
    {"patch",
     [](const Placement &at) {
         return Area(Objects().Quad(at.Points({-.002, 0, -.002, .002, 0, -.002, -.002, 0, .002, .002, .001, .002})));
     }},
};
const Part kHousings[] = {
    {"ball", [](const Placement &at) { return Objects().Sphere(.01 * at.scale); }},
    {"box",
     [](const Placement &at) {
         constexpr double a = .005;
         return Objects().Triangles(
             at.Points({-a, -a, -a, a, -a, -a, -a, a, -a, a, a, -a, -a, -a, a, a, -a, a, -a, a, a, a, a, a}),
             "0 1 3 0 3 2  4 7 5 4 6 7  0 5 1 0 4 5  2 3 7 2 7 6  0 2 6 0 6 4  1 5 7 1 7 3");
     }},
};

/// Connections from the inside of a box to the floor miss chords of its edges that are shorter than a unit in the last
/// place of their length.
void ExpectDarkHousings(const Placement &at) {
    for (const Part &light : kLights)
        for (const ScaleIntegrator &integrator : AllIntegrators(at, 64)) {
            const auto mean = [&](const Objects &housing) {
                return MeanOf(RenderSeeds(DistantFloorText(at, integrator, light.objects(at), housing), 1)[0]);
            };
            const bool connectsInside = integrator.name == "bdpt" || integrator.name == "mlt";
            for (const Part &housing : kHousings)
                EXPECT_LE(mean(housing.objects(at)), connectsInside ? 1e-4 : 0)
                    << at.Name() << ", " << light.name << " in a " << housing.name << ", " << integrator.name;
            if (integrator.name == "lightpath") continue;
            EXPECT_GT(mean({}), 1e-3) << light.name << ", " << integrator.name;
        }
}

TEST(Housings, AreDark) { ExpectDarkHousings({}); }
TEST(Housings, AreDarkAtEveryScale) {
    ExpectDarkHousings({.scale = 1e-6});
    ExpectDarkHousings({.scale = 1e6});
}

/// A lid of 1 mm before a lens that looks at a lamp 100 units away.
TEST(Housings, OfCamerasAreDark) {
    for (const ScaleIntegrator &integrator : AllIntegrators({}, 64))
        for (const bool lid : {true, false}) {
            Objects world = Objects().PointLight("0 0 60", "1e4 1e4 1e4").Diffuse(".5 .5 .5");
            world.Quad("-90 -90 100  90 -90 100  -90 90 100  90 90 100");
            if (lid) world.Shape("disk", "'float radius' .01 'float height' .001");
            const std::string text = ViewText({}, integrator, {0, 0, 0, 0, 0, 1, 0, 1, 0}, 60, 3, world);
            const double mean = MeanOf(RenderSeeds(text, 1)[0]);
            EXPECT_EQ(mean > 0, !lid) << integrator.name << ", " << mean;
        }
}

}  // namespace
}  // namespace pbrt::test
