#include "ext/lab/reference.h"

#include <cstring>

#include "experiment_fixture.h"

namespace ext::lab {

TEST_F(Experiment, ReferenceIsKeptInTheCacheAndReused) {
    const ExperimentOutcome first = Run(Settings("one", {"uniform"}));
    const std::vector<fs::path> kept = ReferencesIn("cache");
    ASSERT_GE(kept.size(), 1u);
    for (const char *elsewhere : {"", "one"}) EXPECT_EQ(ReferencesIn(elsewhere).size(), 0u) << elsewhere;
    EXPECT_NE(first.text.find(kept[0].parent_path().string()), std::string::npos) << first.text;
    const auto time = fs::last_write_time(kept[0]);
    Run(Settings("two", {"uniform"}));
    EXPECT_EQ(fs::last_write_time(kept[0]), time);
    // A reference file that was cut short is rendered again, with the same result.
    const auto size = fs::file_size(kept[0]);
    fs::resize_file(kept[0], size / 2);
    Run(Settings("three", {"uniform"}));
    EXPECT_EQ(fs::file_size(kept[0]), size);
    ExpectSamePictures("one", "three", {"uniform"}, 2);
    // Another scene gets another reference.
    Write("scene.pbrt", ThreeLights() + std::string(Objects().Sphere(0.2)));
    Run(Settings("four", {"uniform"}));
    EXPECT_GT(ReferencesIn("cache").size(), kept.size());
}

TEST_F(Experiment, ReferencesThatWereChangedAreRenderedAgain) {
    Run(Settings("first", {"uniform"}));
    const std::string path = ReferencesIn("cache").at(0).string();
    const ImageFile good = ReadImage(path);
    const auto expectAgain = [&](const std::string &what, auto &&change) {
        ImageFile changed = good;
        change(changed);
        WriteImage(path, changed.image, changed.metadata);
        Run(Settings(what, {"uniform"}));
        const ImageFile again = ReadImage(path);
        ASSERT_EQ(again.image.Channels(), good.image.Channels()) << what;
        EXPECT_EQ(std::memcmp(again.image.Data(), good.image.Data(), good.image.Bytes()), 0) << what;
        for (const char *name : {"lightlab.parts", "lightlab.sampler", "samplesPerPixel"})
            EXPECT_EQ(again.metadata.attributes.at(name), good.metadata.attributes.at(name)) << what;
        EXPECT_TRUE(again.metadata.attributes.contains("lightlab.hash")) << what;
    };
    for (const std::string channel : {"G", "part3.B"})
        expectAgain(channel, [&](ImageFile &file) { file.image.Set({4, 5}, file.image.FindChannel(channel), 0.125f); });
    expectAgain("parts", [](ImageFile &file) { file.metadata.attributes["lightlab.parts"] = 7; });
    expectAgain("samples", [](ImageFile &file) { file.metadata.attributes["samplesPerPixel"] = 7; });
    expectAgain("sampler", [](ImageFile &file) { file.metadata.attributes["lightlab.sampler"] = std::string("x"); });
    expectAgain("no-hash", [](ImageFile &file) { file.metadata.attributes.erase("lightlab.hash"); });
}

TEST(ReferenceCache, DefaultFolderIsTheUsers) {
    const char *const names[] = {"XDG_CACHE_HOME", "HOME"};
    std::vector<std::optional<std::string>> before;
    for (const char *name : names)
        before.emplace_back(std::getenv(name) ? std::optional<std::string>(std::getenv(name)) : std::nullopt);
    setenv("XDG_CACHE_HOME", "/somewhere/cache", 1);
    setenv("HOME", "/home/me", 1);
    EXPECT_EQ(UserCacheFolder(), "/somewhere/cache/pbrt_octree");
    setenv("XDG_CACHE_HOME", "relative", 1);
    EXPECT_EQ(UserCacheFolder(), "/home/me/.cache/pbrt_octree");
    unsetenv("XDG_CACHE_HOME");
    EXPECT_EQ(UserCacheFolder(), "/home/me/.cache/pbrt_octree");
    unsetenv("HOME");
    EXPECT_EQ(UserCacheFolder(), "");
    for (size_t i = 0; i < 2; ++i)
        if (before[i]) setenv(names[i], before[i]->c_str(), 1);
}

// Uniform chooses the lamp once in 20,000 samples and finds the ceiling by BSDF samples, so its pictures are quiet but
// lack a light. The references have few samples. No stock sampler may be called biased for that.
TEST_F(Experiment, ReferencesOfStockThatContradictEachOtherProveNothing) {
    Objects world;
    world.PointLight("0 2 0", "4 4 4");
    for (int i = 0; i < 20000; ++i) world.PointLight(fmt::format("0 9 {}", i), "1e-6 1e-6 1e-6");
    world.Quad("-4 -1 -4  4 -1 -4  -4 -1 4  4 -1 4").AreaLight("1 1 1").Quad("-9 4 -9  -9 4 9  9 4 -9  9 4 9");
    Write("scene.pbrt", ViewOf(world));
    ExperimentSettings settings = Settings("out", {"uniform", "bvh"});
    settings.samplesPerPixel = 4;
    settings.seeds = 4;
    settings.referenceSamples = 16;
    settings.selectionWork = 0;
    const ExperimentOutcome outcome = Run(settings);
    bool wouldHaveBeen = false;
    for (const Json &s : outcome.results.at("samplers")) {
        const Json &bias = s.at("summary").at("bias");
        EXPECT_NE(bias.at("verdict"), "biased") << bias.dump();
        wouldHaveBeen =
            wouldHaveBeen || bias.at("text").get<std::string>().find("so bias is unknown") != std::string::npos;
    }
    EXPECT_TRUE(wouldHaveBeen);
    const Json &conclusion = outcome.results.at("conclusion");
    ASSERT_EQ(conclusion.at("doubts").size(), 1u) << conclusion.dump();
    EXPECT_NE(conclusion.at("doubts").at(0).get<std::string>().find("prove no bias"), std::string::npos)
        << conclusion.dump();
    // Such references rank no sampler, whichever leads, and the terminal prints it, too.
    EXPECT_TRUE(conclusion.at("winner").is_null()) << conclusion.dump();
    EXPECT_NE(outcome.text.find("prove no bias"), std::string::npos) << outcome.text;
}

TEST_F(Experiment, GivenReferenceIsUsedAsItIs) {
    Run(Settings("one", {"power"}));
    ExperimentSettings settings = Settings("two", {"uniform"});
    settings.referenceFile = Path("one/reference-0.exr");
    EXPECT_EQ(Run(settings).results.at("references").size(), 1u);
    ExpectSamePixels(Path("one/reference-0.exr"), Path("two/reference-0.exr"));
    EXPECT_FALSE(fs::exists(folder_ / "two/records/pilot.json"));
}

}  // namespace ext::lab
