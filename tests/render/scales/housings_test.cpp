// Opaque housings around lights let no light out and caps on lenses let none in, however small they are for the
// distance.
#include <gtest/gtest.h>

#include "placed_scene.h"

namespace pbrt::test {
namespace {

/// Floor 150 units below the origin.
std::string DistantFloorText(const Placement &at, const ScaleIntegrator &integrator, const std::string &objects) {
    return ViewText(at, integrator, {0, -149, 5, 0, -150, 0, 0, 1, 0}, "Camera \"perspective\" \"float fov\" 60", 3) +
           "Material \"diffuse\" \"rgb reflectance\" [ .5 .5 .5 ]\n" + objects +
           "Shape \"bilinearmesh\" \"point3 P\" [" +
           at.Points({-50, -150, -50, 50, -150, -50, -50, -150, 50, 50, -150, 50}) + " ]\n";
}

struct Part {
    const char *name;
    std::string (*text)(const Placement &);
};

std::string Area(const std::string &shape) {
    return "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [ 1e9 1e9 1e9 ] \"bool twosided\" true " + shape +
           " AttributeEnd\n";
}
const Part kLights[] = {
    {"point", [](const Placement &at) { return "LightSource \"point\" \"rgb I\" [ " + at.Intensity(1e5) + " ]\n"; }},
    {"ball", [](const Placement &at) { return Area("Shape \"sphere\" \"float radius\" " + at.Length(.003)); }},
    {"cylinder",
     [](const Placement &at) {
         return Area("Shape \"cylinder\" \"float radius\" " + at.Length(.002) + " \"float zmin\" " + at.Length(-.002) +
                     " \"float zmax\" " + at.Length(.002));
     }},
    {"disk",
     [](const Placement &at) { return Area("Rotate 70 1 0 0 Shape \"disk\" \"float radius\" " + at.Length(.003)); }},
    {"triangle",
     [](const Placement &at) {
         return Area("Shape \"trianglemesh\" \"point3 P\" [" +
                     at.Points({-.002, .001, -.002, .002, 0, -.001, 0, .001, .003}) + " ]");
     }},
    {"patch",
     [](const Placement &at) {
         return Area("Shape \"bilinearmesh\" \"point3 P\" [" +
                     at.Points({-.002, 0, -.002, .002, 0, -.002, -.002, 0, .002, .002, .001, .002}) + " ]");
     }},
};
const Part kHousings[] = {
    {"ball", [](const Placement &at) { return "Shape \"sphere\" \"float radius\" " + at.Length(.01) + "\n"; }},
    {"box",
     [](const Placement &at) {
         constexpr double a = .005;
         return "Shape \"trianglemesh\" \"point3 P\" [" +
                at.Points({-a, -a, -a, a, -a, -a, -a, a, -a, a, a, -a, -a, -a, a, a, -a, a, -a, a, a, a, a, a}) +
                " ] \"integer indices\" [ 0 1 3 0 3 2  4 7 5 4 6 7  0 5 1 0 4 5  2 3 7 2 7 6  0 2 6 0 6 4  1 5 7 1 7 3 ]\n";
     }},
};

/// Connections from the inside of a box to the floor miss chords of its edges that are shorter than a unit in the last
/// place of their length.
void ExpectDarkHousings(const Placement &at) {
    for (const Part &light : kLights)
        for (const ScaleIntegrator &integrator : AllIntegrators(at)) {
            const auto mean = [&](const std::string &housing) {
                return MeanOf(RenderSeeds(DistantFloorText(at, integrator, light.text(at) + housing), at, 1)[0]);
            };
            const bool connectsInside = integrator.name == "bdpt" || integrator.name == "mlt";
            for (const Part &housing : kHousings)
                EXPECT_LE(mean(housing.text(at)), connectsInside ? 1e-4 : 0)
                    << at.Name() << ", " << light.name << " in a " << housing.name << ", " << integrator.name;
            if (integrator.name == "lightpath") continue;
            EXPECT_GT(mean(""), 1e-3) << light.name << ", " << integrator.name;
        }
}

TEST(Housings, AreDark) { ExpectDarkHousings({}); }
TEST(Housings, AreDarkAtEveryScale) {
    ExpectDarkHousings({.scale = 1e-6});
    ExpectDarkHousings({.scale = 1e6});
}

/// A lid of 1 mm before a lens that looks at a lamp 100 units away.
TEST(Housings, OfCamerasAreDark) {
    for (const ScaleIntegrator &integrator : AllIntegrators({}))
        for (const bool lid : {true, false}) {
            const std::string text =
                ViewText({}, integrator, {0, 0, 0, 0, 0, 1, 0, 1, 0}, "Camera \"perspective\" \"float fov\" 60", 3) +
                "LightSource \"point\" \"point3 from\" [ 0 0 60 ] \"rgb I\" [ 1e4 1e4 1e4 ]\n"
                "Material \"diffuse\" \"rgb reflectance\" [ .5 .5 .5 ]\n"
                "Shape \"bilinearmesh\" \"point3 P\" [ -90 -90 100  90 -90 100  -90 90 100  90 90 100 ]\n" +
                (lid ? "Shape \"disk\" \"float radius\" .01 \"float height\" .001\n" : "");
            const double mean = MeanOf(RenderSeeds(text, {}, 1)[0]);
            EXPECT_EQ(mean > 0, !lid) << integrator.name << ", " << mean;
        }
}

}  // namespace
}  // namespace pbrt::test
