#include <signal.h>
#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <fstream>

#include "program.h"

namespace pbrt::test {

namespace {

/// scenes/dollhouse with another pixel sampler.
std::string DollhouseWith(const std::string &sampler) {
    std::ifstream in(PBRT_SOURCE_DIR "/scenes/dollhouse/dollhouse.pbrt");
    std::string text{std::istreambuf_iterator<char>(in), {}};
    const std::string old = "Sampler \"zsobol\"";
    const size_t at = text.find(old);
    EXPECT_NE(at, std::string::npos);
    return text.replace(at, old.size(), "Sampler \"" + sampler + "\"");
}

/// The process runs pbrt (no longer the shell) and has its own handler for the interrupt signal.
bool CatchesInterrupt(pid_t pid) {
    std::error_code gone;
    if (std::filesystem::read_symlink("/proc/" + std::to_string(pid) + "/exe", gone).filename() != "pbrt") return false;
    std::ifstream status("/proc/" + std::to_string(pid) + "/status");
    for (std::string line; std::getline(status, line);)
        if (line.starts_with("SigCgt:")) return (std::stoull(line.substr(7), nullptr, 16) >> (SIGINT - 1)) & 1;
    return false;
}

}  // namespace

class Threads : public Program, public ::testing::WithParamInterface<std::pair<const char *, const char *>> {};

TEST_P(Threads, NumberOfThreadsDoesNotChangeThePixels) {
    const auto [lightSampler, pixelSampler] = GetParam();
    if (std::string(lightSampler) == "octree") PBRT_SKIP_WITHOUT_EXT();
    Write("scene.pbrt", DollhouseWith(pixelSampler));
    const std::string arguments = std::string("--spp 3 --cropwindow 0.4,0.55,0.4,0.55 --lightsampler ") + lightSampler +
                                  " scene.pbrt --nthreads ";
    const ImageFile one = Render(arguments + "1"), two = Render(arguments + "2"), three = Render(arguments + "3");
    EXPECT_TRUE(SamePixels(one, two));
    EXPECT_TRUE(SamePixels(one, three));
}

INSTANTIATE_TEST_SUITE_P(Samplers, Threads,
                         ::testing::Values(std::pair("bvh", "zsobol"), std::pair("octree", "zsobol"),
                                           std::pair("bvh", "halton"), std::pair("octree", "halton"),
                                           std::pair("bvh", "independent"), std::pair("octree", "independent")),
                         [](const auto &pair) { return std::string(pair.param.first) + "_" + pair.param.second; });

class Budget : public Program {};

TEST_F(Budget, TimedRunsEndAndCountThePrepass) {
    Write("scene.pbrt", SmallScene());
    const bool ext = Has(LightSamplerListing(), "\noctree\n");
    const auto start = std::chrono::steady_clock::now();
    const ImageFile file = Render(std::string("--time 1 --lightsampler ") + (ext ? "octree" : "bvh") + " scene.pbrt");
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    // One sample a pixel takes about a millisecond: the scene's 4 are far exceeded.
    EXPECT_GT(IntOf(file, "samplesPerPixel"), 4);
    EXPECT_GT(seconds, 0.5);
    EXPECT_LT(seconds, 10);
    double preparing = 0;
    if (ext) {
        EXPECT_GT(IntOf(file, "lightSampler.prepassVertices"), 0);
        preparing = NumberOf(file, "lightSampler.prepassSeconds") + NumberOf(file, "lightSampler.octreeBuildSeconds");
        EXPECT_GT(preparing, 0);
    }
    EXPECT_LT(preparing + NumberOf(file, "renderTimeSeconds"), 5);
}

class Interrupt : public Program {};

TEST_F(Interrupt, SavesWhatWasRendered) {
    Write("scene.pbrt", SmallScene());
    Render("--spp 1 scene.pbrt", "reference.exr");
    for (int signal : {SIGINT, SIGTERM}) {
        // The log's first line says that rendering is under way.
        const pid_t pid = Start(
            "--spp 100000000 --outfile out.exr --mse-reference-image reference.exr "
            "--mse-reference-out mse.txt scene.pbrt");
        EXPECT_TRUE(WaitUntil([&] { return !Read("mse.txt").empty(); }));
        EXPECT_FALSE(Exists("out.exr"));
        kill(pid, signal);
        const Outcome o = Wait(pid);
        EXPECT_EQ(o.status, 130);
        EXPECT_TRUE(Has(o.err, "Interrupted")) << o.err;
        ASSERT_TRUE(Exists("out.exr"));
        const ImageFile file = ReadImage(Path("out.exr"));
        EXPECT_EQ(IntOf(file, "pbrt.interrupted"), 1);
        EXPECT_GE(IntOf(file, "samplesPerPixel"), 1);
        Float brightest = 0;
        for (int x = 0; x < 32; ++x) brightest = std::max(brightest, file.image.Get({x, 20}, 0));
        EXPECT_GT(brightest, 0);
        for (const char *name : {"out.exr", "mse.txt"}) std::filesystem::remove(Path(name));
        EXPECT_EQ(Files(), (std::vector<std::string>{"reference.exr", "scene.pbrt"}));
    }
}

TEST_F(Interrupt, BeforeRenderingKeepsTheOldImage) {
    const std::string scene = SmallScene();
    Write("scene.pbrt", scene);
    const ImageFile old = Render("--spp 1 scene.pbrt");
    ASSERT_EQ(mkfifo(Path("pipe").c_str(), 0600), 0);
    const pid_t pid = Start("--outfile out.exr - < pipe");
    std::ofstream pipe(Path("pipe"));  // opens when the program does
    EXPECT_TRUE(WaitUntil([&] { return CatchesInterrupt(pid); }));
    kill(pid, SIGINT);
    pipe << scene;
    pipe.close();
    const Outcome o = Wait(pid);
    EXPECT_EQ(o.status, 130) << o.err;
    EXPECT_TRUE(Has(o.err, "Interrupted")) << o.err;
    EXPECT_TRUE(SamePixels(ReadImage(Path("out.exr")), old));
}

}  // namespace pbrt::test
