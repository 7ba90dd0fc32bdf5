#include "ext/lab/reference.h"

#include <cstring>

#include "experiment_fixture.h"
#include "ext/lab/sampler_run.h"
#include "pbrt/images/metrics.h"
#include "pbrt/samplers/sampler.h"

namespace ext::lab {
namespace {

/// A visible light, and nothing else random than the film positions.
std::string VisibleLight(const std::string &sampler) {
    return SceneText()
        .Head("Option 'disablewavelengthjitter' true")
        .LookAt("0 3 -6  0 0 0  0 1 0")
        .Camera(40)
        .Film(32, 24, "'string filename' 'scene.exr'")
        .Filter("box")
        .Head("Sampler '" + sampler + "'")
        .Integrator("path", 1)
        .World(Objects().AreaLight("1 1 1").Sphere(1));
}

double Difference(const Image &a, const Image &b) { return ImageError(a, b, Metric::RelL2); }

}  // namespace

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

TEST_F(Experiment, FilmPositionsOfPartsRunsAndBatchesDiffer) {
    constexpr double kDiffer = 1e-5;
    for (const std::string &type : Samplers().Names()) {
        Write("scene.pbrt", VisibleLight(type));
        ExperimentSettings settings = Settings("out-" + type, {"uniform"});
        settings.cacheFolder = Path("cache-" + type);
        settings.selectionWork = 0;
        settings.views = false;
        Run(settings);
        const Image reference = ReadImage(ReferencesIn("cache-" + type).at(0).string()).image;
        std::vector<Image> parts;
        for (int part = 1; part <= 8; ++part) {
            const auto channel = [&](char color) { return fmt::format("part{}.{}", part, color); };
            parts.push_back(reference.Select({channel('R'), channel('G'), channel('B')}));
            parts.back().RenameChannels({"R", "G", "B"});
            for (int other = 0; other + 1 < part; ++other)
                EXPECT_GT(Difference(parts[other], parts.back()), kDiffer) << type << other << part;
        }
        const auto run = [&](int seed) {
            return ReadImage(Path(fmt::format("out-{}/uniform/seed{}.exr", type, seed))).image;
        };
        EXPECT_GT(Difference(run(0), run(1)), kDiffer) << type;
        // A part has the samples of a run: 32 / 8 = 4.
        for (const Image &part : parts)
            for (int seed : {0, 1}) EXPECT_GT(Difference(run(seed), part), kDiffer) << type << seed;

        // A batch has four samples per pixel.
        Progress progress;
        const LabScene scene = LoadLabScene(settings, registry_, progress);
        SamplerRun twoBatches(scene, settings.samplers[0], 0, 4, progress);
        ASSERT_TRUE(twoBatches.Prepare() && twoBatches.RenderTo({4, 0}));
        const Image one = twoBatches.Picture();
        ASSERT_TRUE(twoBatches.RenderTo({8, 0}));
        EXPECT_GT(Difference(one, twoBatches.Picture()), kDiffer) << type;
    }
}

TEST_F(Experiment, NoiseOfAReferenceIsThatOfItsFilmPositions) {
    for (const char *type : {"halton", "sobol", "independent"}) {
        Write("scene.pbrt", VisibleLight(type));
        const auto referenceOf = [&](int samples, double *noise) {
            ExperimentSettings settings = Settings(fmt::format("{}-{}", type, samples), {"uniform"});
            settings.referenceSamples = samples;
            settings.selectionWork = 0;
            settings.views = false;
            *noise = Run(settings).results.at("references").at(0).at("noise").get<double>();
            return ReadImage(settings.outFolder + "/reference-0.exr").image;
        };
        double noise = 0, little = 0;
        const double error = Difference(referenceOf(16, &noise), referenceOf(1024, &little));
        EXPECT_LT(error, 3 * noise) << type;
        EXPECT_GT(error, noise / 30) << type;  // the parts of one sequence together are better than their noise
        EXPECT_LT(little, noise / 8) << type;
    }
}

TEST_F(Experiment, ContinuedPhotonMappingHasTheRadiusOfLaterIterations) {
    for (const std::string integrator : {"path", "sppm"}) {
        std::string text = ThreeLights();
        text.replace(text.find("path"), 4, integrator);
        Write("scene.pbrt", text);
        const ExperimentSettings settings = Settings("out", {"uniform"});
        Progress progress;
        const LabScene scene = LoadLabScene(settings, registry_, progress);
        const auto after = [&](int samples) {
            SamplerRun run(scene, settings.samplers[0], 1, 2, progress);
            run.ContinueAfter(samples);
            EXPECT_TRUE(run.Prepare() && run.RenderTo({2, 0}));
            return run.Picture();
        };
        EXPECT_EQ(Difference(after(0), after(100)) > 0, integrator == "sppm") << integrator;
    }
}

TEST_F(Experiment, PixelsOfAdaptiveScenesHaveTheSameNumberOfSamples) {
    std::string text = ThreeLights();
    text.insert(text.find("\"path\"") + 6, " \"bool adaptive\" true");
    Write("scene.pbrt", text);
    Progress progress;
    EXPECT_EQ(LoadLabScene(Settings("out", {"uniform"}), registry_, progress).built.half, nullptr);
}

TEST_F(Experiment, GivenReferenceIsUsedAsItIs) {
    Run(Settings("one", {"power"}));
    ExperimentSettings settings = Settings("two", {"uniform"});
    settings.referenceFile = Path("one/reference-0.exr");
    EXPECT_EQ(Run(settings).results.at("references").size(), 1u);
    ExpectSamePixels(Path("one/reference-0.exr"), Path("two/reference-0.exr"));
    EXPECT_FALSE(fs::exists(folder_ / "two/records/pilot.json"));
}

TEST_F(Experiment, GivenReferencesOfAComparedSamplerAreDoubted) {
    Run(Settings("one", {"power"}));
    ImageFile file = ReadImage(Path("one/reference-0.exr"));
    // A header of lightlab has the label, that of pbrt the name without parameters.
    for (const auto &[attribute, doubted] : {std::pair{"lightlab.sampler", 1u}, {"lightSampler", 2u}}) {
        file.metadata.attributes.erase("lightlab.sampler");
        file.metadata.attributes[attribute] = std::string("honest");
        ExperimentSettings settings = Settings(attribute, {"honest", "uniform", "honest+guide"});
        settings.referenceFile = Path("given.exr");
        settings.samplesPerPixel = 1;
        settings.views = false;
        WriteImage(settings.referenceFile, file.image, file.metadata);
        const Json results = Run(settings).results;
        EXPECT_EQ(results.at("references").at(0).at("sampler"), "honest");
        EXPECT_EQ(results.at("conclusion").at("doubts").size(), doubted) << attribute;
    }
}

TEST_F(Experiment, ReferencesOfOtherScenesAndSettingsAreErrors) {
    Run(Settings("one", {"power"}));
    ExperimentSettings settings = Settings("two", {"uniform"});
    settings.referenceFile = Path("one/reference-0.exr");
    settings.maxDepth = 7;
    ExpectError([&] { Run(settings); }, {"one/reference-0.exr", "pbrt.maxDepth 2", "has 7"});
    settings.maxDepth = {};
    settings.sampledLightOnly = true;
    ExpectError([&] { Run(settings); }, {"one/reference-0.exr", "lightlab.sampledLight 0", "has 1"});
    settings.sampledLightOnly = false;
    Write("scene.pbrt", ThreeLights() + std::string(Objects().Sphere(0.2)));
    ExpectError([&] { Run(settings); }, {"one/reference-0.exr", "lightlab.sceneHash "});
    // Other programs do not say.
    WriteImage(settings.referenceFile, ReadImage(settings.referenceFile).image);
    Run(settings);
    settings.referenceFile = Path("grey.pfm");
    WriteImage(settings.referenceFile, Image(PixelFormat::Float, {32, 24}, {"Y"}));
    settings.outFolder = Path("grey");
    ExpectError([&] { Run(settings); }, {"grey.pfm: has no channel \"R\""});
}

}  // namespace ext::lab
