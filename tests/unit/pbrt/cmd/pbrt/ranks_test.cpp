// pbrt as several processes that mpirun starts.
#include <signal.h>

#include <algorithm>

#include "program.h"

namespace pbrt::test {

class Mpi : public LearningProgram {
  protected:
    void SetUp() override {
        Program::SetUp();
        if (!StartAs(1)) GTEST_SKIP() << "NOT TESTED: this build has no MPI (PBRT_MPI=OFF)";
    }
    /// Starts so many processes of a render with checkpoints, and sends the signal to number `rank` of them once there
    /// is a checkpoint.
    Outcome Signal(const std::string &arguments, int ranks, int rank, int signal) {
        StartAs(ranks);
        const pid_t mpirun = StartUntilWritten(arguments + " --checkpoint-interval 0.01", "c.chk");
        const pid_t process = ProcessOf(mpirun, rank);
        EXPECT_NE(process, 0);
        if (process > 0) kill(process, signal);
        Outcome o = Wait(mpirun);
        EXPECT_NE(o.status, 0);
        return o;
    }
    /// The process that is number `rank` of those that a started mpirun started; 0 if there is none yet.
    static pid_t ProcessOf(pid_t mpirun, int rank) {
        for (const auto &entry : std::filesystem::directory_iterator("/proc")) {
            const std::string name = entry.path().filename();
            if (!std::all_of(name.begin(), name.end(), [](char c) { return c >= '0' && c <= '9'; })) continue;
            std::ifstream in(entry.path() / "environ", std::ios::binary), stat(entry.path() / "stat");
            const std::string environment{std::istreambuf_iterator<char>(in), {}};
            std::string word, parent;
            for (int i = 0; i < 4 && stat >> word; ++i) parent = word;
            if (parent == std::to_string(mpirun) &&
                Has(environment, "OMPI_COMM_WORLD_RANK=" + std::to_string(rank) + std::string(1, '\0')))
                return std::stoi(name);
        }
        return 0;
    }
    /// Of the renders that are ended.
    const std::string resumed_ = lights_ + "scene.pbrt --nthreads 1 --checkpoint c.chk --outfile out.exr --resume";
};

TEST_F(Mpi, AnyNumberOfProcessesGivesTheSameBits) {
    // All numbers with the film that holds most, one each with the others.
    for (const auto &[film, numbers] : {std::pair("rgb", std::vector{3}), {"gbuffer", {2, 3, 4}}, {"spectral", {2}}}) {
        Write("scene.pbrt", LearningScene(film, 24));
        ExpectSameBits(lights_ + "scene.pbrt", numbers,
                       ext_ ? "lightSampler.learnedFromShadowRays" : "samplesPerPixel");
    }
}

TEST_F(Mpi, GuidedPaths) {
    PBRT_SKIP_WITHOUT_EXT();
    Write("scene.pbrt", GuidedScene(24));
    const ImageFile file = ExpectSameBits(lights_ + "--guide scene.pbrt", {2, 3}, "guide.guidingCells");
    EXPECT_GT(IntOf(file, "guide.guidingCells"), 0);
    EXPECT_GT(IntOf(file, "guide.rouletteCells"), 0);
}

TEST_F(Mpi, WithoutLearningAndUnderAnEnvironmentLight) {
    Write("scene.pbrt", LearningScene("rgb", 5));
    for (const std::string &arguments :
         std::vector<std::string>{"--lightsampler bvh", lights_ + "--integrator sppm --spp 9",
                                  "--integrator mlt --spp 9", "--lightsampler bvh --pixel 7,7 --spp 200"})
        ExpectSameBits(arguments + " scene.pbrt", {3});
    Write("sky.pbrt", WindowScene("0 0 -1.8", 2, "1 2 3"));
    if (!ext_) ExpectSameBits(lights_ + "--spp 33 sky.pbrt", {3});
    PBRT_SKIP_WITHOUT_EXT();
    const ImageFile file = ExpectSameBits("--lightsampler octree:portals=always,prepassspp=1 --spp 33 sky.pbrt", {3},
                                          "lightSampler.portals");
    EXPECT_EQ(IntOf(file, "lightSampler.portals"), 1);
}

TEST_F(Mpi, AKilledRenderIsResumedByAnyNumberOfRanks) {
    Write("scene.pbrt", LearningScene("gbuffer", 1024));
    for (int killed = 0; killed < 2; ++killed) {
        const Outcome o = Signal(resumed_, 2 + killed, killed, SIGKILL);
        EXPECT_TRUE(Has(o.err + o.out, "signal 9")) << o.err << o.out;
        EXPECT_FALSE(Exists("out.exr"));
    }
    StartAs(3);
    EXPECT_TRUE(Has(RunWell(resumed_), "Resuming from c.chk"));
    StartAs(1);
    EXPECT_TRUE(SamePixels(ReadImage(Path("out.exr")), Render(lights_ + "scene.pbrt", "whole.exr")));
}

TEST_F(Mpi, ASignalToAnyProcessSavesWhatAllHaveDone) {
    Write("scene.pbrt", LearningScene("rgb", 2048));
    for (int rank = 0; rank < 2; ++rank) {
        const Outcome o = Signal(resumed_, 2, rank, SIGTERM);
        ExpectWords(o.err, {"c.chk holds what was rendered"});
        EXPECT_EQ(CountOf(o.err, "holds what was rendered;"), 1u) << o.err;
        // The next one resumes amid a wave that other processes began.
        std::filesystem::remove(Path("out.exr"));
    }
    StartAs(1);
    RunWell(resumed_);
    EXPECT_TRUE(SamePixels(ReadImage(Path("out.exr")), Render(lights_ + "scene.pbrt", "whole.exr")));
}

TEST_F(Mpi, TimePartsAndSavedLights) {
    Write("scene.pbrt", LearningScene("rgb", 32));
    const std::string one = lights_ + "scene.pbrt --nthreads 1 ";
    StartAs(2);
    const ImageFile timed = Render(one + "--time 1.5");
    RunWell(one + "--samples 10:32 --checkpoint b.part");
    RunWell(one + "--write-partial-images --outfile partial.exr" + (ext_ ? " --save-lights many" : ""));
    StartAs(1);
    EXPECT_TRUE(SamePixels(ReadImage(Path("partial.exr")), Render(one + (ext_ ? "--save-lights one" : ""))));
    const ImageFile whole = Render(one);
    RunWell(one + "--samples 0:10 --checkpoint a.part");
    EXPECT_TRUE(SamePixels(whole, Merged("merged.exr a.part b.part")));
    EXPECT_GT(IntOf(timed, "samplesPerPixel"), 32);
    EXPECT_TRUE(SamePixels(timed, RenderWithoutClock(one, timed)));
    if (!ext_) return;
    const ImageFile loaded = Render(one + "--load-lights many");
    EXPECT_TRUE(SamePixels(loaded, Render(one + "--load-lights one")));
    StartAs(2);
    EXPECT_TRUE(SamePixels(loaded, Render(one + "--load-lights one")));
}

TEST_F(Mpi, ErrorsAreReportedOnce) {
    Write("scene.pbrt", LearningScene("rgb", 4));
    Write("wrong.pbrt", LearningScene("rgb", 4) + "Shape \"spher\"\n");
    StartAs(3);
    for (const auto &[arguments, message] : {std::pair("wrong.pbrt", "spher"),
                                             {"--spp none scene.pbrt", "--spp"},
                                             {"-", "mpirun"},
                                             {"scene.pbrt --load-lights missing", "missing: there is no such"}}) {
        const Outcome o = Run(std::string("--quiet ") + arguments);
        SCOPED_TRACE(arguments + ("\n" + o.err));
        EXPECT_EQ(o.status, 1);
        EXPECT_EQ(CountOf(o.err, "Error: "), 1u);
        EXPECT_TRUE(Has(o.err, message));
    }
    EXPECT_EQ(CountOf(Run("--help").out, "Renders pbrt-v4 scene files"), 1u);

    // Files that one of them does not see.
    std::filesystem::create_directory(Path("elsewhere"));
    Write("start.sh", "[ $OMPI_COMM_WORLD_RANK = 1 ] && cd elsewhere\nexec \"$@\"\n");
    StartAs(2, "sh start.sh");
    const Outcome o = Run("--quiet scene.pbrt");
    EXPECT_EQ(o.status, 1);
    ExpectWords(o.err, {"1 of 2 processes", "scene.pbrt"});
    EXPECT_FALSE(Exists("scene.exr"));

    // What another program than Open MPI's mpirun started does not render several pictures into one file.
    launcher_ = "env -u OMPI_COMM_WORLD_SIZE PMI_SIZE=2 PMI_RANK=0";
    ExpectErrors({{"scene.pbrt", {"2 processes", "Open MPI"}}});
}

}  // namespace pbrt::test
