#include "ext/lab/noise_by_depth.h"
#include "experiment_fixture.h"
#include "pbrt/core/files.h"

namespace ext::lab {

TEST(NoiseByDepth, IsTheVarianceOverTheReferenceSquared) {
    Image reference(PixelFormat::Float, {40, 50}, {"R", "G"});
    std::vector<Image> pictures(2, reference);
    ForEachValue(reference, [&](Point2i p, int c) {
        reference.Set(p, c, 0.3f);
        pictures[0].Set(p, c, 0.2f);
        pictures[1].Set(p, c, c == 0 ? 0.4f : 0.2f);
    });
    // Of two values 0.2 apart the variance is 0.02, in one of two channels; the epsilon is 0.01 * 0.3^2.
    EXPECT_NEAR(NoiseOf(pictures, reference).plain, 0.01 / 0.0909, 1e-6);
    EXPECT_NEAR(NoiseOf(pictures, reference).trimmed, 0.01 / 0.0909, 1e-6);
    // One of 2,000 pixels is a firefly: the two worst are left out.
    pictures[1].Set({7, 8}, 1, 1000);
    EXPECT_GT(NoiseOf(pictures, reference).plain, 100);
    EXPECT_NEAR(NoiseOf(pictures, reference).trimmed, 0.01 / 0.0909, 1e-6);
}

TEST(NoiseByDepth, DepthsEndWithTheLargest) {
    EXPECT_EQ(NoiseDepths(1), (std::vector<int>{1}));
    EXPECT_EQ(NoiseDepths(5), (std::vector<int>{1, 2, 3, 4, 5}));
    EXPECT_EQ(NoiseDepths(24), (std::vector<int>{1, 2, 3, 4, 6, 8, 12, 16, 24}));
}

TEST_F(Experiment, AttributesNoiseToPathDepth) {
    // A point light lights the floor without noise but that of colours. What a bounce from it finds on the second floor
    // above is noisy.
    Write("scene.pbrt", SceneText()
                            .LookAt("0 1 -6  0 0 0  0 1 0")
                            .Camera(40)
                            .Film(16, 16, "'string filename' 'scene.exr'")
                            .Samples(4)
                            .Head("PixelFilter 'box' 'float xradius' 0.01 'float yradius' 0.01")
                            .Integrator("path", 2)
                            .World(Objects()
                                       .PointLight("0 1 0", "4 4 4")
                                       .Diffuse("0.8 0.8 0.8")
                                       .Quad("-4 -1 -4  4 -1 -4  -4 -1 4  4 -1 4")
                                       .Quad("-1 2 -1  1 2 -1  -1 2 1  1 2 1")));
    ExperimentSettings settings = Settings("noise", {"uniform", "uniform+guide"});
    settings.samplesPerPixel = 8;
    settings.seeds = 4;
    Progress progress;
    testing::internal::CaptureStdout();
    EXPECT_EQ(RunNoise(settings, registry_, progress), 0);
    EXPECT_NE(testing::internal::GetCapturedStdout().find("uniform+guide"), std::string::npos);
    const Json json = ReadJson(folder_ / "noise/noise.json");
    for (const auto &sampler : json.at("samplers")) {
        ASSERT_EQ(sampler.at("depths").size(), 2u);
        const double first = sampler.at("depths").at(0).at("plain"), second = sampler.at("depths").at(1).at("plain");
        EXPECT_LT(first, 0.25 * second) << json.dump();
        EXPECT_GT(second, 1e-4) << json.dump();
    }
    EXPECT_GT(fs::file_size(folder_ / "noise/index.html"), 1000u);
    settings.seeds = 1;
    EXPECT_THROW(RunNoise(settings, registry_, progress), UserError);
}

TEST_F(Experiment, NoiseMayFallWithPathDepth) {
    // The sky behind the sphere has its light only from the second event on: before, the outline is noisy.
    Write("scene.pbrt", SceneText()
                            .Head("Option 'disablewavelengthjitter' true")
                            .LookAt("0 0 -6  0 0 0  0 1 0")
                            .Camera(30)
                            .Film(8, 8, "'string filename' 'scene.exr'")
                            .Samples(4)
                            .Integrator("path", 2)
                            .World(Objects().Sky("1 1 1").Material("dielectric", "'float eta' 1.01").Sphere()));
    Progress progress;
    testing::internal::CaptureStdout();
    RunNoise(Settings("noise", {"uniform"}), registry_, progress);
    testing::internal::GetCapturedStdout();
    const Json depths = ReadJson(folder_ / "noise/noise.json").at("samplers").at(0).at("depths");
    const double first = depths.at(0).at("plain"), last = depths.at(1).at("plain");
    EXPECT_LT(last, 0.5 * first);
    const std::string page = ReadFileContents(Path("noise/index.html"));
    EXPECT_NE(page.find(fmt::format(">{:.3g}</text>", last)), std::string::npos);
    EXPECT_EQ(page.find(fmt::format(">{:.3g}</text>", first)), std::string::npos);
}

}  // namespace ext::lab
