// Guided paths have the mean of plain ones, in rooms of many kinds and in scenes that are built against guides.
#include <gtest/gtest.h>

#include "agreement_statistics.h"
#include "ext/guiding/path_guide.h"
#include "guide_rooms.h"
#include "support/render_waves.h"
#include "support/scene_text.h"
#include "support/temporary_image.h"

namespace pbrt::test {
namespace {

constexpr int kRuns = 2;  ///< standard errors are then well below the largest ones that are let pass

/// `guidedRuns` is counted up if the guide chose directions in the end.
Image Render(GuideRoom room, int seed, bool guide, int *guidedRuns) {
    BuildOptions options;
    options.seed = seed;
    options.guide = guide;
    if (!guide) room.parameters += " 'bool guide.roulette' false";
    room.sampler = "paddedsobol";  // its pixels are independent as well, and less noisy
    const BuiltScene built = BuildText(GuideRoomText(room), options);
    const ext::PathGuide *learned = GuideOf(built);
    EXPECT_EQ(learned != nullptr, guide);
    Image image = RenderWaves(built, kGuideSamples, {kGuideSamples});
    *guidedRuns += learned && learned->Cells().Guide();
    return image;
}

struct Runs {
    PixelStatistics pictures;
    int guided = 0;
};

Runs RunAll(const GuideRoom &room, int firstSeed, bool guide, int count = kRuns, Float factor = 1) {
    Runs runs;
    for (int run = 0; run < count; ++run) {
        Image image = Render(room, firstSeed + run, guide, &runs.guided);
        ForEachValue(image, [&](Point2i p, int c) { image.Set(p, c, image.Get(p, c) * factor); });
        runs.pictures.Add(image);
    }
    return runs;
}

/// `largestError`: of the mean of the picture; a larger one is a failure. Returns the pictures of plain paths.
PixelStatistics ExpectTheMeanOfPlainPaths(const GuideRoom &room, double largestError = 0.01, int count = kRuns) {
    const PixelStatistics plain = RunAll(room, 1000, false, count).pictures;
    GuideRoom withoutDirections = room, withDirections = room;
    withoutDirections.parameters += " 'bool guide.directions' false";
    withDirections.parameters += " 'float guide.leastsaved' 0";
    for (const bool directions : {false, true}) {
        const Runs runs = RunAll(directions ? withDirections : withoutDirections, 2000, true, count);
        EXPECT_EQ(runs.guided > 0, directions) << room.name;
        const Agreement a = Compare(runs.pictures, {&plain}, 3, 1e-3);
        EXPECT_TRUE(a.Agrees()) << room.name << ": p " << a.worstP << " at " << a.worst;
        EXPECT_LT(a.error, largestError) << room.name << ": too noisy to compare";
        std::printf("%s: %d of %d runs with directions, mean %+.3f +- %.3f %%, worst p %.2g\n", room.name, runs.guided,
                    count, 100 * a.difference, 100 * a.error, a.worstP);
    }
    return plain;
}

const std::string kMetal = "Material 'conductor' 'float roughness' .4",
                  kCoated = "Material 'coateddiffuse' 'float roughness' 0 'rgb reflectance' [ .5 .5 .5 ]",
                  kMirrors = "Material 'conductor' 'float roughness' 0";

std::string Sampler(const std::string &name = AllSamplers().samplers.Has("octree") ? "octree" : "bvh") {
    return "'string lightsampler' '" + name + "' ";
}

/// A lamp under the ceiling that shines downwards.
Objects Lamp(const std::string &before = "") {
    return Objects().Attribute(before,
                               Objects().AreaLight("8 8 8").Quad("-.5 1.95 .5  .5 1.95 .5  -.5 1.95 1.5  .5 1.95 1.5"));
}

TEST(MeanOfGuidedPaths, UnderASpotAtTheCeiling) {
    const GuideRoom room{.name = "spot", .light = kSpotAtCeiling, .parameters = Sampler("bvh")};
    const PixelStatistics plain = ExpectTheMeanOfPlainPaths(room);
    EXPECT_FALSE(Compare(RunAll(room, 3000, true, kRuns, 1.05f).pictures, {&plain}, 3, 1e-3).Agrees())
        << "too bright, and not noticed";
}

TEST(MeanOfGuidedPaths, OverMetal) {
    const GuideRoom room{.name = "metal", .light = kPanelBehindCurtain, .floor = kMetal, .parameters = Sampler("bvh")};
    ExpectTheMeanOfPlainPaths(room);
    GuideRoom foggy = room;
    foggy.name = "metal in fog";
    foggy.fog = true;
    ExpectTheMeanOfPlainPaths(foggy);
}

TEST(MeanOfGuidedPaths, OverACoat) {
    ExpectTheMeanOfPlainPaths(
        {.name = "coated", .light = kPanelBehindCurtain, .floor = kCoated, .parameters = Sampler("uniform")});
}

// Scenes that are built against guides.

TEST(MeanOfGuidedPaths, WithACaustic) {
    ExpectTheMeanOfPlainPaths({.name = "caustic",
                               .light = Lamp()
                                            .Attribute("Translate 0 .7 .8 Material 'dielectric'", Objects().Sphere(.5))
                                            .Attribute("Translate -1.3 .5 .3 " + kMirrors, Objects().Sphere(.4)),
                               .parameters = Sampler()},
                              0.02);
}

TEST(MeanOfGuidedPaths, ThroughASlit) {
    // A wall from front to back with a slit of 20 cm; the lamp and its spot on the ceiling are behind it.
    ExpectTheMeanOfPlainPaths(
        {.name = "slit",
         .light = Objects()
                      .Add("LightSource 'spot' 'point3 from' [ 2 .6 0 ] 'point3 to' [ 2.5 2 .5 ] 'rgb I' [ 60 60 60 ] "
                           "'float coneangle' 32 'float conedeltaangle' 3")
                      .Diffuse(".7 .7 .7")
                      .Quad("1.2 0 -3  1.2 0 .5  1.2 2 -3  1.2 2 .5")
                      .Quad("1.2 0 .7  1.2 0 3  1.2 2 .7  1.2 2 3"),
         .parameters = Sampler()},
        0.03, 6);
}

TEST(MeanOfGuidedPaths, WithLightThatMoves) {
    // A lamp in a corner shines on a card that moves, from where all other light comes, and through a moving glass.
    ExpectTheMeanOfPlainPaths(
        {.name = "moving light",
         .light = Objects()
                      .Add("LightSource 'spot' 'point3 from' [ -2 .3 0 ] 'point3 to' [ 1 1.5 1 ] 'rgb I' [ 60 60 60 ] "
                           "'float coneangle' 20 'float conedeltaangle' 3")
                      .Add(Lamp("Scale .5 1 1"))
                      .Attribute("ActiveTransform EndTime Translate 1.2 -.5 .8 ActiveTransform All",
                                 Objects()
                                     .Diffuse(".9 .9 .9")
                                     .Quad("0 1 .5  .8 1 1.3  0 1.8 .5  .8 1.8 1.3")
                                     .Add("Translate -.6 .4 1 Material 'dielectric'")
                                     .Sphere(.3)),
         .parameters = Sampler()},
        0.02);
}

TEST(MeanOfGuidedPaths, BetweenMirrors) {
    ExpectTheMeanOfPlainPaths(
        {.name = "mirror room", .light = kPanelBehindCurtain, .walls = kMirrors, .parameters = Sampler()}, 0.02);
}

TEST(MeanOfGuidedPaths, UnderASunOfOnePixel) {
    const TemporaryImage sky("sun.exr", RgbImage({32, 32}, [](int x, int y) {
                                 return x == 16 && y == 16 ? Rgb(3000.f) : Rgb(.05f, .06f, .1f);
                             }));
    ExpectTheMeanOfPlainPaths(
        {.name = "sun of one pixel",
         .light = Objects().Attribute("Rotate -25 1 0 0",
                                      Objects().Light("infinite", "'string filename' '" + sky.Path() + "'")),
         .parameters = Sampler(),
         .window = true},
        0.02);
}

TEST(MeanOfGuidedPaths, InAGlossyCorridor) {
    // Two walls of rough metal, from front to back; the lamp's light comes round the end of one of them.
    ExpectTheMeanOfPlainPaths({.name = "glossy corridor",
                               .light = Objects()
                                            .Add(kSpotAtCeiling)
                                            .Material("conductor", "'float roughness' .15")
                                            .Quad("-.7 0 -3  -.7 0 3  -.7 2 -3  -.7 2 3")
                                            .Quad("-.2 0 -2.4  -.2 0 1.2  -.2 2 -2.4  -.2 2 1.2"),
                               .parameters = Sampler()},
                              0.02);
}

}  // namespace
}  // namespace pbrt::test
