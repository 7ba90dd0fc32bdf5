#include "experiment_fixture.h"

#include "ext/lab/reference.h"
#include "pbrt/build/light_sampler_spec.h"
#include "pbrt/scenefile/content_hash.h"
#include "support/test_clock.h"

namespace ext::lab {

TEST(SamplerList, KeysBelongToTheSamplerBeforeThem) {
    EXPECT_EQ(SplitSamplerList("a,b:k=1,m=2,c+mesh,d+guide:k=1,m=2, e"),
              (std::vector<std::string>{"a", "b:k=1,m=2", "c+mesh", "d+guide:k=1,m=2", "e"}));
    EXPECT_EQ(SplitSamplerList("a+guide,b+guide:k=1,m=2,c"),
              (std::vector<std::string>{"a+guide", "b+guide:k=1,m=2", "c"}));
    EXPECT_EQ(SafeFileName("octree:leaves=64,floor=.2+guide:a/b"), "octree_leaves=64,floor=.2+guide_a_b");
}

TEST(SamplerChoice, OnlyTheWordMeshIsLeftOut) {
    EXPECT_EQ(WithoutMesh("bvh+mesh"), "bvh");
    EXPECT_EQ(WithoutMesh("octree:floor=1e+3+mesh+guide:k=1"), "octree:floor=1e+3+guide:k=1");
    EXPECT_EQ(WithoutMesh("bvh+guide+mesh"), "bvh+guide");
    for (const char *other : {"bvh", "bvh+meshes", "mesh+guide", ""}) EXPECT_EQ(WithoutMesh(other), other);
}

TEST(RankMakers, AReferenceHasTheLeastVarianceForItsSamplesOrItsTime) {
    PilotEntry slow, fast;
    slow.choice.label = "slow";
    slow.variance = 1;
    slow.secondsPerSample = 4;
    fast.choice.label = "fast";
    fast.variance = 2;
    fast.secondsPerSample = 1;
    ExperimentSettings settings;
    EXPECT_EQ(RankMakers(settings, {fast, slow})[0].choice.label, "slow");
    settings.timeBudget = 1;
    EXPECT_EQ(RankMakers(settings, {slow, fast})[0].choice.label, "fast");
    settings.referenceSamples = 64;
    EXPECT_EQ(RankMakers(settings, {fast, slow})[0].choice.label, "slow");
}

TEST(Checkpoints, StartAtOneSampleAndEndAtTheBudget) {
    ExperimentSettings settings;
    settings.samplesPerPixel = 24;
    std::vector<int> samples;
    for (const RenderTarget &c : Checkpoints(settings)) samples.push_back(c.samples);
    EXPECT_EQ(samples, (std::vector<int>{1, 2, 4, 8, 16, 24}));
    settings.samplesPerPixel = 1;
    EXPECT_EQ(Checkpoints(settings).size(), 1u);
    settings.samplesPerPixel = 2'000'000'000;
    const std::vector<RenderTarget> most = Checkpoints(settings);
    ASSERT_EQ(most.size(), 32u);
    EXPECT_EQ(most[30].samples, 1 << 30);
    EXPECT_EQ(most[31].samples, 2'000'000'000);
    settings.timeBudget = 32;
    const std::vector<RenderTarget> timed = Checkpoints(settings);
    ASSERT_EQ(timed.size(), 8u);
    EXPECT_EQ(timed[0].samples, 1);
    EXPECT_EQ(timed[1].seconds, 0.5);
    EXPECT_EQ(timed[7].seconds, 32);
}

TEST(ReferenceRule, HasSixteenTimesTheSamplesUpToALimit) {
    ExperimentSettings settings;
    for (const auto &[samples, ofReference] :
         {std::pair{1, 512}, {64, 1024}, {200'000'000, 1 << 30}, {2'147'483'647, 1 << 30}}) {
        settings.samplesPerPixel = samples;
        EXPECT_EQ(ReferenceRule::For(settings).samples, ofReference) << samples;
    }
    settings.referenceSamples = 2'147'483'647;
    EXPECT_EQ(ReferenceRule::For(settings).samples, 1 << 30);
}

TEST(ExperimentDisplay, TimeLeftIsThatOfTheWholeExperiment) {
    struct Sink final : ProgressSink {
        void Show(const std::string &p, double f, double e, double r) override {
            phase = p;
            fraction = f;
            elapsed = e;
            remaining = r;
        }
        void PhaseDone(const std::string &, double) override {}
        std::string phase;
        double fraction = -1, elapsed = 0, remaining = -2;
    } sink;
    pbrt::test::TestClock clock;
    const Progress time(nullptr, std::ref(clock));
    ExperimentDisplay display(&sink, time);
    auto show = [&](double left) {
        clock.Advance(std::chrono::milliseconds(200));  // the display is updated at most every 0.2 s
        display.Show(left);
    };
    display.SetPhase("pilot");
    clock.Advance(std::chrono::milliseconds(199));
    display.Show(-1);
    EXPECT_EQ(sink.fraction, -1);
    show(-1);
    EXPECT_EQ(sink.phase, "pilot");
    EXPECT_EQ(sink.fraction, 0);
    EXPECT_LT(sink.remaining, 0);
    display.SetPhase("reference 0");
    display.SetAfter(3);
    show(2);
    EXPECT_EQ(sink.phase, "reference 0");
    EXPECT_EQ(sink.remaining, 5);
    EXPECT_NEAR(sink.elapsed, 0.599, 1e-9);
    EXPECT_NEAR(sink.fraction, 0.599 / 5.599, 1e-9);
    display.SetAfter(0);
    show(0);
    EXPECT_EQ(sink.remaining, 0);
    EXPECT_EQ(sink.fraction, 1);
}

TEST_F(Experiment, SceneHashDependsOnEveryFileThatIsNamed) {
    Write("a.pbrt", "Include \"b.pbrt\"\n# \"c.ply\"\n");
    Write("b.pbrt", "Shape \"plymesh\" \"string filename\" \"mesh.ply\"\n");
    Write("mesh.ply", "one");
    Write("c.ply", "comment");
    const std::string path = Path("a.pbrt"), hash = SceneHash(path);
    EXPECT_EQ(hash.size(), 16u);
    EXPECT_EQ(SceneHash(path), hash);
    Write("c.ply", "not read");
    EXPECT_EQ(SceneHash(path), hash);
    Write("mesh.ply", "two");
    const std::string second = SceneHash(path);
    EXPECT_NE(second, hash);
    Write("b.pbrt", "Shape \"plymesh\" \"string filename\" \"mesh.ply\" \n");
    EXPECT_NE(SceneHash(path), second);
}

}  // namespace ext::lab
