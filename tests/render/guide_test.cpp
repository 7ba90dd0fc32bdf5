// Guided paths: the same bits however the work is divided, nothing changes where nothing is to be gained.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "ext/guiding/path_guide.h"
#include "guide_rooms.h"
#include "pbrt/core/parallel.h"
#include "support/render_waves.h"
#include "support/scene_text.h"

namespace pbrt::test {
namespace {

constexpr int kSamples = kGuideSamples;

Image Render(const BuiltScene &built, const std::vector<int> &sizes = {kSamples}) {
    return RenderWaves(built, kSamples, sizes);
}

BuiltScene Spot(bool guide, const std::string &sampler = "bvh", bool fog = false) {
    return BuildText(GuideRoomText(
        {.light = kSpotAtCeiling,
         .parameters = "'string lightsampler' '" + sampler + "' 'bool guide' " + (guide ? "true" : "false"),
         .fog = fog,
         .size = 32}));  // bits are compared, not means
}

TEST(GuidedPaths, AreGuidedWhereLightComesFromOnePlace) {
    for (const bool fog : {false, true}) {
        BuiltScene built = Spot(true, "bvh", fog);
        Render(built);
        nlohmann::ordered_json report;
        GuideOf(built)->Report(report);
        EXPECT_GT(report["guidingCells"].get<int>(), fog ? 2 : 5) << report.dump();
        EXPECT_GT(report["rouletteCells"].get<int>(), 5) << report.dump();
    }
}

TEST(GuidedPaths, LearnTheSameFromAnyRadiance) {
    const auto learned = [](const std::string &scale) {
        BuiltScene built = BuildText(GuideRoomText({.light = kSpotAtCeiling + " 'float scale' " + scale,
                                                    .parameters = "'string lightsampler' 'bvh' 'bool guide' true",
                                                    .size = 32}));
        Render(built);
        nlohmann::ordered_json report;
        GuideOf(built)->Report(report);
        report.erase("learningSeconds");
        return report;
    };
    const nlohmann::ordered_json expected = learned("1");
    EXPECT_GT(expected["guidingCells"].get<int>(), 5);
    EXPECT_EQ(learned("1.2089258196146292e24"), expected);  // 2^80
    EXPECT_EQ(learned("8.271806125530277e-25"), expected);  // 2^-80
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
            SceneText()
                .LookAt("0 0 -4  0 0 0  0 1 0")
                .Camera(60)
                .Film(40, 40)
                .Samples(16)
                .Integrator("path", 6, "'bool guide.roulette' false")
                .World(Objects().Sky("1 1 1").Diffuse(".8 .8 .8").Sphere(1).Add("Translate 1.5 0 0").Sphere(1)),
            options);
        return Render(built);
    };
    EXPECT_TRUE(SameBits(render(true), render(false)));
}

void ExpectToGoOnBitByBit(bool fog, std::initializer_list<int> stops) {
    BuiltScene uninterrupted = Spot(true, "bvh", fog);
    const Image whole = Render(uninterrupted);
    for (const int stop : stops) {
        PartRender first(Spot(true, "bvh", fog), kSamples);
        first.RenderUntil(stop);
        StateWriter writer;
        first.built.integrator->SaveLearned(writer, true);
        const std::string state = writer.Joined();
        StateReader reader(state, "state");
        PartRender second(Spot(true, "bvh", fog), kSamples, &reader), third(Spot(true, "bvh", fog), kSamples);
        EXPECT_EQ(reader.BytesLeft(), 0u);
        for (PartRender *part : {&second, &third}) part->LoadFilm(first.SavedFilm());
        second.renderer->GoOnFrom({stop, 0, {}});
        third.renderer->ContinueFrom(stop);  // traces again what it learns from
        for (PartRender *part : {&second, &third}) {
            part->RenderUntil(kSamples);
            EXPECT_TRUE(SameBits(whole, part->built.film->ToImage())) << "stopped after " << stop;
        }
    }
}

TEST(GuidedPaths, ContinueFromASavedStateBitByBit) {
    ExpectToGoOnBitByBit(false, {0, 1, 2, 5, 8, 12, 33});
    // Records of places in media differ, when they are learned from does not.
    ExpectToGoOnBitByBit(true, {1, 8, 33});
}

TEST(GuidedPaths, OnlyPathAndVolpathAreGuided) {
    BuildOptions options;
    options.guide = true;
    options.integrator = "bdpt";
    EXPECT_THROW(BuildText(GuideRoomText({.light = kSpotAtCeiling}), options), UserError);
    options.guide = false;
    options.lightSampler = "bvh+guide";
    EXPECT_THROW(BuildText(GuideRoomText({.light = kSpotAtCeiling}), options), UserError);
}

TEST(GuidedPaths, AreChosenWithParametersTogetherWithTheLightSampler) {
    const auto built = [](const std::string &choice, const std::string &scene = "") {
        BuildOptions options;
        options.lightSampler = choice;
        return BuildText(GuideRoomText({.light = kSpotAtCeiling, .parameters = scene}), options);
    };
    EXPECT_EQ(GuideOf(built("bvh")), nullptr);
    const BuiltScene plain = built("bvh+guide");
    ASSERT_NE(GuideOf(plain), nullptr);
    EXPECT_TRUE(GuideOf(plain)->EstimatesDirections());
    EXPECT_FALSE(GuideOf(built("bvh+mesh+guide:directions=false,share=.5"))->EstimatesDirections());
    // Keys are added to those of the scene.
    EXPECT_FALSE(GuideOf(built("bvh+guide:share=.5", "'bool guide.directions' false"))->EstimatesDirections());
    for (const char *wrong :
         {"bvh+guide:length=3", "bvh+guide:share=2", "bvh+guide:directions=1", "bvh+guide:", "bvh+guided"})
        EXPECT_THROW(built(wrong), UserError) << wrong;
}

}  // namespace
}  // namespace pbrt::test
