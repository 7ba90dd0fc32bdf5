// --adaptive and --noise as a user runs them.
#include <signal.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "pbrt/images/metrics.h"
#include "program.h"

namespace pbrt::test {

namespace {

/// A ball under lights of very different power, one of which is chosen, before a wall that shines: noise is in a small
/// part of the image.
std::string NoisyBall(int samples, const std::string &integrator = "", const std::string &sampler = "zsobol",
                      const std::string &film = "rgb") {
    Objects world;
    for (int i = 0; i < 40; ++i)
        world.PointLight(fmt::format("{} {} -3", i % 8 - 4, i / 8 - 2), i == 9 ? "20 20 20" : "0.5 0.4 0.3");
    world.Attribute("", Objects()
                            .Diffuse("0 0 0")
                            .AreaLight("0.5 0.6 0.7", "'bool twosided' true")
                            .Quad("-9 -9 2  9 -9 2  -9 9 2  9 9 2"));
    world.Diffuse("0.7 0.6 0.5").Attribute("Translate 0.8 0.3 0", Objects().Sphere(0.5));
    return SceneText()
        .LookAt("0 0 -5  0 0 0  0 1 0")
        .Camera(40)
        .Film(64, 48, "'string filename' 'x.exr' 'bool savefp16' false", film)
        .Head(fmt::format("Sampler '{}' 'integer pixelsamples' {}", sampler, samples))
        .Integrator("path", 1, "'string lightsampler' 'uniform' " + integrator)
        .World(world);
}

/// Expects that pixels have different numbers of samples.
void ExpectAdaptive(const ImageFile &image) {
    EXPECT_GT(IntOf(image, "pbrt.maxSamples"), IntOf(image, "pbrt.minSamples"));
}

double Noise(const ImageFile &image, const ImageFile &reference) {
    const std::vector<std::string> colors = {"R", "G", "B"};
    return std::sqrt(ImageError(image.image.Select(colors), reference.image.Select(colors), Metric::RelL2));
}

}  // namespace

class Adaptive : public LearningProgram {
  protected:
    // Random wavelengths would be noise of the wall.
    const std::string plain_ = " --disable-wavelength-jitter ", adaptive_ = plain_ + "--adaptive ",
                      learning_ = lights_ + adaptive_;
};

TEST_F(Adaptive, ImagesDoNotDependOnThreadsOrSplits) {
    Write("scene.pbrt", NoisyBall(48, "", "independent", "gbuffer"));
    const ImageFile one = Render(learning_ + "scene.pbrt --nthreads 1 --aov samples");
    ExpectAdaptive(one);
    for (const char *other : {"--nthreads 2", "--nthreads 3 --checkpoint c.chk --checkpoint-interval 0.001"})
        EXPECT_TRUE(SamePixels(one, Render(learning_ + "scene.pbrt --aov samples " + other))) << other;
    EXPECT_FALSE(SamePixels(one, Render("--lightsampler bvh scene.pbrt --aov samples" + plain_)));
}

TEST_F(Adaptive, KilledAndInterruptedRendersResumeToTheSameBits) {
    Write("scene.pbrt", NoisyBall(1024, "", "independent"));
    for (const std::string integrator : {"path", "bdpt"}) {
        const std::string arguments = (integrator == "path" ? learning_ : adaptive_) + "--integrator " + integrator +
                                      (integrator == "path" ? " " : " --spp 256 ") + "scene.pbrt --aov samples ";
        const ImageFile whole = Render(arguments, "whole.exr");
        ExpectAdaptive(whole);
        EXPECT_TRUE(Has(StopAndResume(arguments + "--nthreads 2", {SIGKILL, SIGINT, SIGKILL}), "Resuming"));
        EXPECT_TRUE(SamePixels(whole, ReadImage(Path("out.exr")))) << integrator;
        RunWell(arguments + "--outfile out.exr --checkpoint c.chk --resume");  // finished
        EXPECT_TRUE(SamePixels(whole, ReadImage(Path("out.exr"))));
        std::filesystem::remove(Path("c.chk"));
    }
}

TEST_F(Adaptive, AnyNumberOfProcessesGivesTheSameBits) {
    if (!StartAs(1)) GTEST_SKIP() << "NOT TESTED: this build has no MPI (PBRT_MPI=OFF)";
    Write("scene.pbrt", NoisyBall(64, "", "independent", "spectral"));
    for (const std::string &flags : {learning_, adaptive_ + "--integrator bdpt --spp 32 "})
        ExpectAdaptive(ExpectSameBits(flags + "scene.pbrt", {2, 3}, "pbrt.noise"));
}

TEST_F(Adaptive, TheNoiseReachedIsTheNoiseRequested) {
    Write("ball.pbrt", NoisyBall(16));
    Write("room.pbrt", GuidedScene(16));
    for (const auto &[scene, noise] : {std::pair("ball.pbrt", 0.06), {"room.pbrt", 0.15}}) {
        const std::string file = std::string(scene) + " --lightsampler uniform ";
        // Two references give an estimate of their own noise, which is not small.
        const ImageFile reference = Render(file + "--spp 512 --seed 9", "reference.exr"),
                        other = Render(file + "--spp 512 --seed 10", "other.exr");
        const ImageFile image = Render(file + fmt::format("--spp 4096 --noise {}", noise));
        EXPECT_LT(IntOf(image, "samplesPerPixel"), 1000) << scene;
        EXPECT_LE(NumberOf(image, "pbrt.noise"), noise) << scene;
        const double found = Sqr(Noise(image, reference)) - Sqr(Noise(other, reference)) / 2;
        EXPECT_NEAR(std::sqrt(found) / noise, 1, 0.2) << scene;
    }
    // A lower level continues the render; the same one does nothing.
    const std::string level = "ball.pbrt --spp 512 --checkpoint c.chk --resume --noise ";
    const ImageFile first = Render(level + "0.2");
    EXPECT_TRUE(SamePixels(first, Render(level + "0.2")));
    EXPECT_GT(IntOf(Render(level + "0.1"), "samplesPerPixel"), IntOf(first, "samplesPerPixel"));
    EXPECT_TRUE(Has(RunWell("ball.pbrt --spp 8 --noise 0.001 --outfile x.exr"), "not reached"));
    EXPECT_TRUE(
        Has(RunWell("ball.pbrt --quick --noise 0.1 --outfile x.exr"), "not reached: there are too few samples"));
}

TEST_F(Adaptive, SingleRowsAndPixels) {
    Write("ball.pbrt", NoisyBall(32));
    for (const char *pixels : {"--pixel 40,21", "--pixel 40,22", "--pixelbounds 3,60,21,22"})
        EXPECT_GT(NumberOf(Render(fmt::format("ball.pbrt {} {}", adaptive_, pixels)), "pbrt.noise"), 0) << pixels;
}

TEST_F(Adaptive, LessNoiseWithTheSameSamples) {
    Write("ball.pbrt", NoisyBall(32, "'bool adaptive' true", "independent"));
    Write("plain.pbrt", NoisyBall(32, "", "independent"));
    const ImageFile reference = Render("plain.pbrt --spp 1024 --seed 9" + plain_, "reference.exr");
    const ImageFile adaptive = Render("ball.pbrt --aov samples" + plain_), uniform = Render("plain.pbrt" + plain_);
    EXPECT_LT(Noise(adaptive, reference), 0.75 * Noise(uniform, reference));
    EXPECT_TRUE(SamePixels(adaptive, Render("plain.pbrt --aov samples" + adaptive_)));
    // The samples are at the ball, and their number is the mean.
    const int channel = adaptive.image.FindChannel("samples");
    ASSERT_GE(channel, 0);
    double sum = 0;
    ForEachPixel(adaptive.image, [&](Point2i p) { sum += double(adaptive.image.Get(p, channel)); });
    EXPECT_NEAR(sum / (64 * 48), 32, 0.1);
    EXPECT_NEAR(NumberOf(adaptive, "pbrt.meanSamples"), sum / (64 * 48), 1e-4);
    EXPECT_GT(adaptive.image.Get({40, 22}, channel), 4 * adaptive.image.Get({4, 4}, channel));
}

TEST_F(Adaptive, StatisticsAreReported) {
    Write("ball.pbrt", NoisyBall(16));
    const std::string noise = "ball.pbrt --noise 0.1 --spp 256 --outfile x.exr ";
    ExpectWords(Run(noise + "--stats").out, {"mean, smallest, largest", "waves planned, uniform, gain"});
    const auto json = nlohmann::json::parse(Run(noise + "--stats=json").out)["adaptive"];
    EXPECT_EQ(json["noiseRequested"], 0.1);
    EXPECT_LE(json["noise"], 0.1);
    EXPECT_GE(json["maxSamples"], json["minSamples"]);
    EXPECT_GE(json["decisions"], json["uniformDecisions"]);
    EXPECT_GE(json["predictedGain"], 0);
    const std::string few = Run("ball.pbrt --adaptive --spp 4 --stats=json --outfile x.exr").out;
    EXPECT_EQ(nlohmann::json::parse(few)["adaptive"]["meanSamples"], 4.0);
    EXPECT_LE(NumberOf(Render("ball.pbrt --time 0.5 --noise 0.2"), "pbrt.noise"), 0.2);
}

TEST_F(Adaptive, ImpossibleCombinationsAreErrors) {
    Write("ball.pbrt", NoisyBall(4));
    Write("adaptive.pbrt", NoisyBall(4, "'bool adaptive' true"));
    Write("fixed.pbrt", NoisyBall(4, "", "halton' 'string randomization' 'none"));
    ExpectErrors({{"--noise 0.1 fixed.pbrt", {"fixed.pbrt:", "--noise", "randomization"}},
                  {"--adaptive --integrator mlt ball.pbrt", {"--adaptive", "mlt", "path"}},
                  {"--adaptive --integrator sppm ball.pbrt", {"--adaptive", "sppm", "bdpt"}},
                  {"--noise 0.1 --integrator lightpath ball.pbrt", {"--noise", "lightpath", "path"}},
                  {"--noise 0 ball.pbrt", {"--noise: \"0\" is not a finite number above 0"}},
                  {"--noise inf ball.pbrt", {"--noise: \"inf\" is not a finite number above 0"}},
                  {"--noise much ball.pbrt", {"--noise", "much"}},
                  {"--adaptive --samples 0:2 --checkpoint c.chk ball.pbrt", {"--samples", "--adaptive"}},
                  {"--samples 0:2 --checkpoint c.chk adaptive.pbrt", {"--samples", "adaptive"}}});
    RunWell("ball.pbrt --checkpoint c.chk --outfile x.exr");
    ExpectErrors({{"ball.pbrt --adaptive --checkpoint c.chk --resume --outfile x.exr", {"--adaptive"}}});
}

}  // namespace pbrt::test
