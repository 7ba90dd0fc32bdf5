#include "pbrt/core/progress.h"
#include "program.h"

namespace pbrt::test {

class Threads : public Program {};

TEST_F(Threads, NumberDoesNotChangeThePixelsOfTheHaltonSampler) {
    const std::string text = Read(PBRT_SOURCE_DIR "/scenes/dollhouse/dollhouse.pbrt");
    Write("scene.pbrt", Replaced(text, "Sampler \"zsobol\"", "Sampler \"halton\""));
    for (const std::string lights : {"bvh", "octree"}) {
        if (lights == "octree" && !HasExt()) continue;
        const std::string arguments =
            "--spp 3 --cropwindow 0.4,0.55,0.4,0.55 scene.pbrt --lightsampler " + lights + " --nthreads ";
        const ImageFile one = Render(arguments + "1");
        for (const char *threads : {"2", "3"}) EXPECT_TRUE(SamePixels(one, Render(arguments + threads))) << arguments;
    }
}

class Budget : public LearningProgram {};

TEST_F(Budget, TimedRunsEndAndCountThePrepass) {
    Write("scene.pbrt", SmallScene());
    const auto start = std::chrono::steady_clock::now();
    const ImageFile file = Render("--time 1" + lights_ + "scene.pbrt");
    const double seconds = SecondsSince(start);
    // One sample per pixel takes about a millisecond, so many more than the 4 of the scene are rendered.
    EXPECT_GT(IntOf(file, "samplesPerPixel"), 4);
    EXPECT_GT(seconds, 0.5);
    EXPECT_LT(seconds, 10);
    double preparing = 0;
    if (ext_) {
        EXPECT_GT(IntOf(file, "lightSampler.prepassVertices"), 0);
        preparing = NumberOf(file, "lightSampler.prepassSeconds") + NumberOf(file, "lightSampler.octreeBuildSeconds");
        EXPECT_GT(preparing, 0);
    }
    EXPECT_LT(preparing + NumberOf(file, "renderTimeSeconds"), 5);
}

TEST_F(Budget, TimeIsPreparedForAsTheSamplesThatItAllows) {
    PBRT_SKIP_WITHOUT_EXT();
    Write("scene.pbrt", LearningScene("rgb", 4));
    for (const char *quick : {"", "--quick "}) {
        const std::string arguments = quick + lights_ + "scene.pbrt";
        const ImageFile timed = Render("--time 1.5 " + arguments);
        const int planned = IntOf(timed, "pbrt.plannedSamplesPerPixel"), taken = IntOf(timed, "samplesPerPixel");
        // The machine may do other work meanwhile.
        EXPECT_GT(planned, 16);
        EXPECT_LT(planned, 8 * taken);
        EXPECT_GT(planned, taken / 8);
        const ImageFile same = Render("--spp " + std::to_string(planned) + " " + arguments);
        EXPECT_EQ(IntOf(timed, "lightSampler.prepassVertices"), IntOf(same, "lightSampler.prepassVertices"));
        const ImageFile few = Render("--spp 1 " + arguments);
        EXPECT_GT(IntOf(timed, "lightSampler.prepassVertices"), IntOf(few, "lightSampler.prepassVertices"));
        EXPECT_TRUE(SamePixels(timed, RenderWithoutClock(arguments, timed))) << planned << ' ' << taken;
    }
    // Without a light sampler there is nothing to plan.
    EXPECT_EQ(IntOf(Render("--time 0.2 --integrator randomwalk scene.pbrt"), "pbrt.plannedSamplesPerPixel"), 4);
}

TEST_F(Budget, EveryIntegratorIsMeasured) {
    Write("scene.pbrt", LearningScene("rgb", 1));
    for (const char *integrator : {"path", "volpath", "bdpt", "sppm", "simplepath", "lightpath", "mlt"}) {
        const ImageFile file = Render(std::string("--quick --time 0.5 --integrator ") + integrator + " scene.pbrt");
        EXPECT_GT(IntOf(file, "samplesPerPixel"), 1) << integrator;
    }
    PBRT_SKIP_WITHOUT_EXT();
    EXPECT_GT(IntOf(Render("--quick --guide --time 0.5 scene.pbrt"), "pbrt.plannedSamplesPerPixel"), 1);
}

}  // namespace pbrt::test
