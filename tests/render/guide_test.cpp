// Guided paths: the mean is that of plain paths, the same bits however the work is divided, nothing changes where
// nothing is to be gained.
#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <sstream>

#include "agreement_statistics.h"
#include "pbrt/core/parallel.h"
#include "pbrt/core/state_io.h"
#include "pbrt/integrators/path_guide.h"
#include "pbrt/integrators/render_loop.h"
#include "support/render_waves.h"

namespace pbrt::test {
namespace {

constexpr int kSamples = 16;  ///< the guide learns after 2 and 8

/// `fog`: the room is full of it, and the integrator is volpath.
std::string Room(const std::string &parameters, const std::string &floor, const std::string &light, bool fog = false) {
    const std::string medium =
        "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_s\" [ .3 .25 .2 ] "
        "\"rgb sigma_a\" [ .02 .02 .04 ] \"float g\" .4\nMediumInterface \"\" \"fog\"\n";
    return R"(Option "rendercoordsys" "world"
LookAt 0 1.2 -2.8  0 0.8 0  0 1 0
)" + (fog ? medium : "") +
           R"(Camera "perspective" "float fov" 60
Film "rgb" "integer xresolution" 48 "integer yresolution" 48 "bool savefp16" false
Sampler "independent" "integer pixelsamples" 16
Integrator ")" +
           (fog ? "volpath" : "path") + "\" \"integer maxdepth\" 4 " + parameters + "\nWorldBegin\n" + light + R"(
Material "diffuse" "rgb reflectance" [ .6 .5 .4 ]
Shape "bilinearmesh" "point3 P" [ -3 2 -3  3 2 -3  -3 2 3  3 2 3 ]
Shape "bilinearmesh" "point3 P" [ -3 0 -3  3 0 -3  -3 2 -3  3 2 -3 ]
Shape "bilinearmesh" "point3 P" [ -3 0 3  3 0 3  -3 2 3  3 2 3 ]
Shape "bilinearmesh" "point3 P" [ 3 0 -3  3 0 3  3 2 -3  3 2 3 ]
Shape "bilinearmesh" "point3 P" [ -3 0 -3  -3 0 3  -3 2 -3  -3 2 3 ]
)" + floor +
           R"(
Shape "bilinearmesh" "point3 P" [ -3 0 -3  3 0 -3  -3 0 3  3 0 3 ]
)";
}

/// A lamp that lights a part of the ceiling, from where all other light comes.
const std::string kSpot =
    "LightSource \"spot\" \"point3 from\" [ 0 .6 0 ] \"point3 to\" [ 1 2 1 ] \"rgb I\" [ 60 60 60 ] "
    "\"float coneangle\" 32 \"float conedeltaangle\" 3";
/// A lamp that both light sampling and bounces find, beside a wall that hides it from a part of the room.
const std::string kPanel =
    "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [ 8 8 8 ] \"bool twosided\" true "
    "Shape \"bilinearmesh\" \"point3 P\" [ 1 .1 1  2 .1 1  1 1 1  2 1 1 ] AttributeEnd\n"
    "Material \"diffusetransmission\" Shape \"bilinearmesh\" \"point3 P\" [ .8 0 -1  .8 0 3  .8 1.6 -1  .8 1.6 3 ]";
const std::string kDiffuse = "Material \"diffuse\"", kMetal = "Material \"conductor\" \"float roughness\" .4",
                  kCoated = "Material \"coateddiffuse\" \"float roughness\" 0 \"rgb reflectance\" [ .5 .5 .5 ]";

struct Case {
    const char *name;
    std::string floor, light, sampler;
    bool fog = false;
};
const Case kCases[] = {{"spot", kDiffuse, kSpot, "\"string lightsampler\" \"bvh\" "},
                       {"metal", kMetal, kPanel, "\"string lightsampler\" \"bvh\" "},
                       {"coated", kCoated, kPanel, "\"string lightsampler\" \"uniform\" "},
                       {"metal in fog", kMetal, kPanel, "\"string lightsampler\" \"bvh\" ", true}};

void Prepare(BuiltScene &built, Progress &progress, StateReader *learned = nullptr) {
    PrepareContext context = built.Preparation(progress);
    context.samplesPerPixel = kSamples;
    context.learned = learned;
    built.integrator->Prepare(context);
}

RenderSettings Settings() {
    RenderSettings settings;
    settings.samplesPerPixel = kSamples;
    return settings;
}

Image Render(BuiltScene &built, const std::vector<int> &sizes = {kSamples}) {
    Progress progress;
    Prepare(built, progress);
    return RenderWaves(built, kSamples, sizes, progress);
}

BuiltScene Spot(bool guide, const std::string &sampler = "bvh", bool fog = false) {
    return BuildText(Room("\"string lightsampler\" \"" + sampler + "\" \"bool guide\" " + (guide ? "true" : "false") +
                              " \"bool guide.directions\" true",
                          kDiffuse, kSpot, fog));
}

TEST(GuidedPaths, HaveTheMeanOfPlainPaths) {
    for (const Case &c : kCases) {
        const auto statistics = [&](bool guide, int firstSeed, Float factor = 1, bool directions = false) {
            PixelStatistics s;
            for (int run = 0; run < 24; ++run) {
                BuildOptions options;
                options.seed = firstSeed + run;
                options.guide = guide;
                BuiltScene built = BuildText(
                    Room(c.sampler + (directions ? "\"bool guide.directions\" true" : ""), c.floor, c.light, c.fog),
                    options);
                Image image = Render(built);
                EXPECT_EQ(built.integrator->Guide() != nullptr, guide);
                for (int y = 0; factor != 1 && y < 48; ++y)
                    for (int x = 0; x < 48; ++x)
                        for (int k = 0; k < 3; ++k) image.Set({x, y}, k, image.Get({x, y}, k) * factor);
                s.Add(image);
            }
            return s;
        };
        const PixelStatistics plain = statistics(false, 1000);
        for (const bool directions : {false, true}) {
            const Agreement a = Compare(statistics(true, 2000, 1, directions), {&plain}, 3, 1e-3);
            EXPECT_TRUE(a.Agrees()) << c.name << ": p " << a.worstP << " at " << a.worst;
            EXPECT_LT(a.error, 0.01) << c.name << ": too noisy to tell";
            std::printf("%s%s: mean %+.3f +- %.3f %%, worst p %.2g\n", c.name, directions ? " with directions" : "",
                        100 * a.difference, 100 * a.error, a.worstP);
        }
        const Agreement spoilt = Compare(statistics(true, 3000, 1.05f), {&plain}, 3, 1e-3);
        EXPECT_FALSE(spoilt.Agrees()) << c.name << ": 5 % too bright, and not noticed";
    }
}

TEST(GuidedPaths, AreGuidedWhereLightComesFromOnePlace) {
    for (const bool fog : {false, true}) {
        BuiltScene built = Spot(true, "bvh", fog);
        Render(built);
        nlohmann::ordered_json report;
        built.integrator->Guide()->Report(report);
        EXPECT_GT(report["guidingCells"].get<int>(), fog ? 2 : 5) << report.dump();
        EXPECT_GT(report["rouletteCells"].get<int>(), 5) << report.dump();
    }
}

TEST(GuidedPaths, AreTheSameForAnyThreadsAndAnySplit) {
    for (const auto &[sampler, fog] : {std::pair("bvh", false), {"octree", false}, {"bvh", true}}) {
        if (!AllSamplers().samplers.Has(sampler)) continue;
        const auto render = [&](int threads, const std::vector<int> &sizes, bool guide = true) {
            ThreadLimit limit(threads);
            BuiltScene built = Spot(guide, sampler, fog);
            return Render(built, sizes);
        };
        const Image whole = render(1, {kSamples});
        EXPECT_TRUE(SameBits(whole, render(3, {kSamples})));
        EXPECT_TRUE(SameBits(whole, render(2, {1})));
        EXPECT_TRUE(SameBits(whole, render(1, {3, 2, 7, 1})));
        EXPECT_FALSE(SameBits(whole, render(1, {kSamples}, false))) << "nothing was guided";
    }
}

TEST(GuidedPaths, DirectionsChangeNothingUnderEvenLight) {
    const auto render = [](bool guide) {
        BuildOptions options;
        options.guide = guide;
        BuiltScene built = BuildText(
            "LookAt 0 0 -4 0 0 0 0 1 0 Camera \"perspective\" \"float fov\" 60\n"
            "Film \"rgb\" \"integer xresolution\" 40 \"integer yresolution\" 40\n"
            "Sampler \"independent\" \"integer pixelsamples\" 16\n"
            "Integrator \"path\" \"integer maxdepth\" 6 \"bool guide.roulette\" false \"bool guide.directions\" true\n"
            "WorldBegin\n"
            "LightSource \"infinite\" \"rgb L\" [ 1 1 1 ]\n"
            "Material \"diffuse\" \"rgb reflectance\" [ .8 .8 .8 ]\n"
            "Shape \"sphere\" Translate 1.5 0 0 Shape \"sphere\"\n",
            options);
        return Render(built);
    };
    EXPECT_TRUE(SameBits(render(true), render(false)));
}

void ExpectToGoOnBitByBit(bool fog) {
    BuiltScene uninterrupted = Spot(true, "bvh", fog);
    const Image whole = Render(uninterrupted);
    const RenderSettings settings = Settings();
    for (const int stop : {0, 1, 2, 5, 8, 12}) {
        Progress progress;
        std::stringstream film;
        StateWriter writer;
        std::string state;
        {
            BuiltScene built = Spot(true, "bvh", fog);
            Prepare(built, progress);
            WaveRenderer renderer(*built.integrator, *built.camera, *built.filter, *built.film, *built.sampler,
                                  settings, progress);
            while (renderer.Done() < stop) renderer.Render(stop - renderer.Done());
            built.film->Save(film);
            built.integrator->SaveLearned(writer);
            state = writer.Joined();
        }
        StateReader reader(state, "state");
        BuiltScene built = Spot(true, "bvh", fog);
        Prepare(built, progress, &reader);
        EXPECT_EQ(reader.BytesLeft(), 0u);
        built.film->Load(film);
        WaveRenderer renderer(*built.integrator, *built.camera, *built.filter, *built.film, *built.sampler, settings,
                              progress);
        renderer.GoOnFrom({stop, 0, {}});
        while (renderer.Done() < kSamples) renderer.Render(kSamples);
        EXPECT_TRUE(SameBits(whole, built.film->ToImage())) << "stopped after " << stop;
        // A part of the render that traces again what it learns from.
        BuiltScene part = Spot(true, "bvh", fog);
        Prepare(part, progress);
        film.clear();
        film.seekg(0);
        part.film->Load(film);
        WaveRenderer again(*part.integrator, *part.camera, *part.filter, *part.film, *part.sampler, settings, progress);
        again.ContinueFrom(stop);
        while (again.Done() < kSamples) again.Render(kSamples);
        EXPECT_TRUE(SameBits(whole, part.film->ToImage())) << "continued from " << stop;
    }
}

TEST(GuidedPaths, GoOnFromASavedStateBitByBit) {
    ExpectToGoOnBitByBit(false);
    ExpectToGoOnBitByBit(true);
}

TEST(GuidedPaths, OnlyPathAndVolpathAreGuided) {
    BuildOptions options;
    options.guide = true;
    options.integrator = "bdpt";
    EXPECT_THROW(BuildText(Room("", kDiffuse, kSpot), options), UserError);
    options.guide = false;
    options.lightSampler = "bvh+guide";
    EXPECT_THROW(BuildText(Room("", kDiffuse, kSpot), options), UserError);
}

TEST(GuidedPaths, AreChosenWithParametersTogetherWithTheLightSampler) {
    const auto built = [](const std::string &choice, const std::string &scene = "") {
        BuildOptions options;
        options.lightSampler = choice;
        return BuildText(Room(scene, kDiffuse, kSpot), options);
    };
    EXPECT_EQ(built("bvh").integrator->Guide(), nullptr);
    const BuiltScene plain = built("bvh+guide");
    ASSERT_NE(plain.integrator->Guide(), nullptr);
    EXPECT_FALSE(plain.integrator->Guide()->LearnsDirections());
    EXPECT_TRUE(built("bvh+mesh+guide:directions=true,share=.5").integrator->Guide()->LearnsDirections());
    // Keys are added to those of the scene.
    EXPECT_TRUE(built("bvh+guide:share=.5", "\"bool guide.directions\" true").integrator->Guide()->LearnsDirections());
    for (const char *wrong :
         {"bvh+guide:length=3", "bvh+guide:share=2", "bvh+guide:directions=1", "bvh+guide:", "bvh+guided"})
        EXPECT_THROW(built(wrong), UserError) << wrong;
}

}  // namespace
}  // namespace pbrt::test
