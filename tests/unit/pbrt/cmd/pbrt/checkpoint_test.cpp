// --checkpoint, --resume, --samples, --save-lights and --load-lights as a user runs them.
#include <signal.h>

#include "program.h"

namespace pbrt::test {

class Checkpoints : public LearningProgram {
  protected:
    /// Expects the bits of `whole` of a render that StopAndResume kills and resumes with two threads.
    void ExpectSameAfterKills(const ImageFile &whole, const std::string &arguments,
                              const std::vector<int> &signals = {SIGKILL, SIGKILL, SIGKILL}) const {
        ExpectWords(StopAndResume(arguments + " --nthreads 2", signals), {"Resuming from c.chk, after "});
        EXPECT_TRUE(SamePixels(whole, ReadImage(Path("out.exr")))) << arguments;
        std::filesystem::remove(Path("c.chk"));
    }
    /// Renders parts of these ranges, named part and the range, merges them in this order, and expects the bits of
    /// `whole`, a render with the same arguments.
    void ExpectSameFromParts(const ImageFile &whole, const std::string &arguments,
                             const std::vector<std::string> &ranges) const {
        for (const std::string &name : Files())
            if (name.starts_with("part")) std::filesystem::remove(Path(name));
        std::string files;
        for (const std::string &range : ranges) {
            RunWell(arguments + " --nthreads 2 --samples " + range + " --checkpoint part" + range);
            files += " part" + range;
        }
        const ImageFile merged = Merged("merged.exr" + files);
        EXPECT_TRUE(SamePixels(whole, merged)) << arguments;
        EXPECT_EQ(IntOf(merged, "samplesPerPixel"), IntOf(whole, "samplesPerPixel"));
    }
};

TEST_F(Checkpoints, ARenderThatWasKilledGivesTheSameBits) {
    for (const char *film : {"rgb", "gbuffer", "spectral"}) {
        Write("scene.pbrt", LearningScene(film, 512));
        ExpectSameAfterKills(Render(lights_ + "scene.pbrt --nthreads 1", "whole.exr"), lights_ + "scene.pbrt");
        EXPECT_EQ(IntOf(ReadImage(Path("out.exr")), "samplesPerPixel"), 512);
    }
}

/// The interrupted pass resumes in the middle of an iteration, or of a chain.
TEST_F(Checkpoints, PhotonMapsAndChainsResumeToTheSameBits) {
    Write("scene.pbrt", LearningScene("rgb", 8));
    for (const std::string integrator : {"sppm", "mlt"}) {
        const std::string arguments =
            (integrator == "sppm" ? lights_ : "") + "scene.pbrt --spp 700 --integrator " + integrator;
        ExpectSameAfterKills(Render(arguments, "whole.exr"), arguments, {SIGINT, SIGINT, SIGINT});
    }
}

TEST_F(Checkpoints, AGuidedRenderThatWasKilledGivesTheSameBits) {
    PBRT_SKIP_WITHOUT_EXT();
    Write("scene.pbrt", GuidedScene(256));
    const ImageFile whole = Render(lights_ + "--guide scene.pbrt --nthreads 1", "whole.exr");
    EXPECT_GT(IntOf(whole, "guide.guidingCells"), 0);
    EXPECT_GT(IntOf(whole, "guide.rouletteCells"), 0);
    ExpectSameAfterKills(whole, lights_ + "--guide scene.pbrt");
    EXPECT_FALSE(SamePixels(whole, Render(lights_ + "scene.pbrt")));
    // More samples, at once and step by step; without the flag it is another render.
    RunWell(lights_ + "--guide scene.pbrt --spp 12 --checkpoint a.chk --outfile twelve.exr");
    std::filesystem::copy(Path("a.chk"), Path("b.chk"));
    const ImageFile more = Render(lights_ + "--guide scene.pbrt --checkpoint a.chk --resume --spp 29");
    RunWell(lights_ + "--guide scene.pbrt --checkpoint b.chk --resume --spp 17 --outfile b.exr");
    EXPECT_TRUE(SamePixels(more, Render(lights_ + "--guide scene.pbrt --checkpoint b.chk --resume --spp 29")));
    ExpectErrors({{lights_ + "scene.pbrt --checkpoint a.chk --resume --spp 40", {"a.chk", "--guide"}}});
}

TEST_F(Checkpoints, AFinishedRenderResumesWithMoreSamples) {
    Write("scene.pbrt", LearningScene("gbuffer", 8));
    const ImageFile eight = Render(lights_ + "scene.pbrt --checkpoint a.chk");
    // The same at once, without more, and step by step.
    EXPECT_TRUE(SamePixels(eight, Render(lights_ + "scene.pbrt --checkpoint a.chk --resume")));
    EXPECT_TRUE(SamePixels(eight, Render(lights_ + "scene.pbrt")));
    std::filesystem::copy(Path("a.chk"), Path("b.chk"));
    const ImageFile more = Render(lights_ + "scene.pbrt --checkpoint a.chk --resume --spp 29");
    RunWell(lights_ + "scene.pbrt --checkpoint b.chk --resume --spp 13 --outfile b.exr");
    EXPECT_EQ(IntOf(more, "samplesPerPixel"), 29);
    EXPECT_TRUE(SamePixels(more, Render(lights_ + "scene.pbrt --checkpoint b.chk --resume --spp 29")));
    EXPECT_FALSE(SamePixels(more, eight));
    ExpectErrors(
        {{lights_ + "scene.pbrt --checkpoint a.chk --resume --spp 28", {"a.chk", "29 samples per pixel already"}},
         {lights_ + "scene.pbrt --checkpoint a.chk", {"a.chk: exists already", "--resume"}}});
}

TEST_F(Checkpoints, StatisticsAreOfThisRunAndTheHeaderOfAll) {
    Write("scene.pbrt", SmallScene());
    RunWell("--spp 512 --checkpoint a.chk --outfile first.exr scene.pbrt");
    const std::string text = Run("--spp 640 --checkpoint a.chk --resume --stats --outfile out.exr scene.pbrt").out;
    const auto number = [&](const std::string &name) { return std::stod(text.substr(text.find(name) + name.size())); };
    const double all = NumberOf(ReadImage(Path("out.exr")), "renderTimeSeconds");
    EXPECT_GT(all, NumberOf(ReadImage(Path("first.exr")), "renderTimeSeconds"));
    EXPECT_EQ(number("camera paths"), 32 * 24 * 128);
    // Both are printed with few digits. Over the seconds of both runs the rate would be far lower.
    const double rays = number("closest-hit rays") + number("shadow rays");
    EXPECT_NEAR(1e6 * number("rays per second (million)") * number("rendering (s)") / rays, 1, 0.3);
}

TEST_F(Checkpoints, TimedRendersResumeAndHaveTheBitsOfTheirNumberOfSamples) {
    Write("scene.pbrt", LearningScene("rgb", 8));
    // A finished run has no time left; a longer time adds samples. Time that was spent counts.
    const ImageFile first = Render(lights_ + "scene.pbrt --time 0.5 --checkpoint t.chk"),
                    longer = Render(lights_ + "scene.pbrt --time 3 --checkpoint t.chk --resume");
    EXPECT_GT(IntOf(longer, "samplesPerPixel"), std::max(8, IntOf(first, "samplesPerPixel")));
    const int planned = IntOf(first, "pbrt.plannedSamplesPerPixel");
    EXPECT_EQ(IntOf(longer, "pbrt.plannedSamplesPerPixel"), planned);
    EXPECT_GT(planned, 8);
    EXPECT_TRUE(SamePixels(longer, RenderWithoutClock(lights_ + "scene.pbrt", longer)));
}

TEST_F(Checkpoints, InterruptedRendersKeepEverySample) {
    Write("scene.pbrt", LearningScene("rgb", 1024));
    const std::string arguments = lights_ + "scene.pbrt --outfile out.exr --checkpoint c.chk";
    // The first wave is done.
    const pid_t pid = StartUntilWritten(arguments + " --write-partial-images --checkpoint-interval 0.01", "out.exr");
    kill(pid, SIGINT);
    const Outcome o = Wait(pid);
    EXPECT_EQ(o.status, 128 + SIGINT) << o.err;
    ExpectWords(o.err, {"c.chk holds what was rendered", "the image holds what was rendered"});
    EXPECT_LT(IntOf(ReadImage(Path("out.exr")), "samplesPerPixel"), 1024);
    RunWell(arguments + " --resume");
    EXPECT_TRUE(SamePixels(ReadImage(Path("out.exr")), Render(lights_ + "scene.pbrt", "whole.exr")));
}

TEST_F(Checkpoints, ErrorsOfOtherRendersNameTheDifference) {
    Write("scene.pbrt", LearningScene("rgb", 4));
    Write("part.pbrt", "Shape \"sphere\" \"float radius\" 0.1\n");
    Write("more.pbrt", LearningScene("rgb", 4) + "Include \"part.pbrt\"\n");
    RunWell("more.pbrt --maxdepth 2 --checkpoint c.chk --outfile out.exr");
    const std::string resume = "--checkpoint c.chk --resume --outfile out.exr ";
    ExpectErrors({{resume + "more.pbrt", {"c.chk: ", "--maxdepth is not given", "2 in c.chk"}},
                  {resume + "more.pbrt --maxdepth 3 --seed 1", {"--maxdepth is 3", "is 2", "--seed is 1", "not given"}},
                  {resume + "scene.pbrt --maxdepth 2", {"only c.chk", "more.pbrt", "file scene.pbrt"}},
                  {resume + "more.pbrt --maxdepth 2 --samples 0:2", {"c.chk", "whole render"}},
                  {"--resume more.pbrt", {"--resume", "--checkpoint"}},
                  {"--checkpoint x.chk - < more.pbrt", {"standard input"}},
                  {"--checkpoint none/x.chk more.pbrt", {"none/x.chk", "folder"}}});
    // The picture that the render wrote, and a comment of another scene, do not matter; a changed include does.
    RunWell(resume + "more.pbrt --maxdepth 2");
    Write("part.pbrt", "Shape \"sphere\" \"float radius\" 0.2\n");
    ExpectErrors({{resume + "more.pbrt --maxdepth 2", {"c.chk", "file part.pbrt"}}});
}

TEST_F(Checkpoints, DamagedFilesAreErrors) {
    Write("scene.pbrt", LearningScene("rgb", 2));
    RunWell(lights_ + "scene.pbrt --outfile out.exr --checkpoint c.chk");
    const std::string whole = Read("c.chk");
    std::vector<ErrorCase> cases;
    for (size_t i = 0; i < 6; ++i) {
        const size_t at = whole.size() * i / 6;
        std::string changed = whole;
        changed[at + 20] = char(changed[at + 20] ^ 1);
        Write(fmt::format("bad{}", i), changed);
        Write(fmt::format("cut{}", i), whole.substr(0, at));
        for (const char *bad : {"bad", "cut"}) {
            const std::string name = bad + std::to_string(i);
            cases.push_back({lights_ + "scene.pbrt --resume --checkpoint " + name, {name}});
        }
    }
    cases.push_back({"scene.pbrt --resume --checkpoint scene.pbrt", {"scene.pbrt: is not a checkpoint"}});
    cases.push_back({"scene.pbrt --load-lights c.chk", {"c.chk: ", "checkpoint", "learned lights"}});
    ExpectErrors(cases);
}

class Parts : public Checkpoints {
  protected:
    /// Expects that imgtool merge writes no none.exr and prints an error with these words.
    void ExpectMergeError(const std::string &arguments, const std::vector<std::string> &words) const {
        const Outcome o = RunImgtool("merge " + arguments);
        EXPECT_EQ(o.status, 1) << arguments;
        ExpectWords(o.err, words);
        EXPECT_FALSE(Exists("none.exr"));
    }
};

TEST_F(Parts, MergedInAnyOrderHaveTheBitsOfOneRender) {
    for (const char *film : {"rgb", "gbuffer", "spectral"}) {
        Write("scene.pbrt", LearningScene(film, 16));
        // With what one render learned, and without learning.
        std::string lights = " --lightsampler bvh ";
        if (ext_ && std::string(film) != "rgb") {
            RunWell("--lightsampler octree scene.pbrt --save-lights lights --outfile train.exr");
            lights = " --lightsampler octree --load-lights lights ";
        }
        const ImageFile whole = Render(lights + "scene.pbrt", "whole.exr");
        ExpectSameFromParts(whole, lights + "scene.pbrt", {"0:1", "1:5", "5:12", "12:16"});
        for (const std::string files : {"part12:16 part5:12 part0:1 part1:5", "part5:12 part0:1 part12:16 part1:5"})
            EXPECT_TRUE(SamePixels(whole, Merged("out.exr " + files))) << files;
        ExpectMergeError("none.exr part0:1 part5:12 part12:16", {"samples 1:5"});
        ExpectMergeError("none.exr part0:1 part1:5 part5:12", {"samples 12:16"});
        ExpectMergeError("none.exr part0:1 part1:5 part5:12 part12:16 part5:12",
                         {"part5:12 (5:12) and part5:12 (5:12)"});
        const ImageFile some = Merged("some.exr --incomplete part0:1 part5:12");
        EXPECT_EQ(IntOf(some, "samplesPerPixel"), 8);
        EXPECT_FALSE(SamePixels(whole, some));
    }
}

/// Integrators that follow light from the lights are divided like all others.
TEST_F(Parts, LightThatIsFollowedFromTheLights) {
    Write("scene.pbrt", LearningScene("rgb", 8));
    for (const std::string integrator : {"lightpath", "bdpt", "sppm", "mlt"}) {
        const std::string arguments = "scene.pbrt --spp 8 --integrator " + integrator;
        ExpectSameFromParts(Render(arguments + " --nthreads 1", "whole.exr"), arguments, {"3:8", "0:1", "1:3"});
    }
}

TEST_F(Parts, PartsOfOtherRendersAndUnfinishedOnesAreErrors) {
    Write("scene.pbrt", LearningScene("rgb", 4));
    Write("other.pbrt", LearningScene("rgb", 4) + "Shape \"sphere\" \"float radius\" 0.2\n");
    RunWell("scene.pbrt --samples 0:2 --checkpoint a");
    RunWell("scene.pbrt --samples 2:4 --checkpoint b --maxdepth 2");
    RunWell("other.pbrt --samples 2:4 --checkpoint c");
    RunWell("scene.pbrt --samples 2:4 --checkpoint d --spp 8");
    ExpectMergeError("none.exr a b", {"--maxdepth", "2"});
    ExpectMergeError("none.exr a c", {"other.pbrt"});
    ExpectMergeError("none.exr a d", {"8 samples per pixel", "4 in a"});
    ExpectMergeError("none.exr a scene.pbrt", {"scene.pbrt: ", "checkpoint"});
    ExpectMergeError("none.jpeg2 a", {"none.jpeg2"});
    Write("long.pbrt", LearningScene("rgb", 4096));
    const pid_t pid = StartUntilWritten("long.pbrt --samples 0:4096 --checkpoint e --checkpoint-interval 0.01", "e");
    kill(pid, SIGKILL);
    Wait(pid);
    ExpectMergeError("none.exr e", {"e: ", "unfinished", "0:4096", " 0:", "--resume", "--incomplete"});
    ExpectMergeError("none.exr a", {"samples 2:4", "--incomplete"});
    RunWell("scene.pbrt --spp 1 --samples 0:1 --checkpoint one");
    ExpectWords(RunImgtool("merge one.exr one").out, {"one.exr: ", "1 sample ", "1 file\n"});
    ExpectErrors({{"scene.pbrt --samples 0:5 --checkpoint f", {"only 4 samples"}},
                  {"scene.pbrt --samples 2:2 --checkpoint f", {"2:2", "0:16"}},
                  {"scene.pbrt --samples 2 --checkpoint f", {"\"2\"", "0:16"}},
                  {"scene.pbrt --samples 0:2", {"--checkpoint"}},
                  {"scene.pbrt --samples 0:2 --time 3 --checkpoint f", {"--time"}},
                  {"scene.pbrt --samples 0:4 --checkpoint a --resume", {"a: ", "0:2", "0:4"}}});
}

TEST_F(Parts, RendersWithAnOpenEndAreMergedOnceFinished) {
    Write("scene.pbrt", LearningScene("rgb", 4096));
    for (const std::string name : {"time", "noise"}) {
        const ImageFile whole =
            Render(fmt::format("scene.pbrt --{0} {1} --checkpoint {0}", name, name == "time" ? 0.2 : 9));
        EXPECT_TRUE(SamePixels(whole, Merged("merged.exr " + name))) << name;
    }
    const pid_t pid =
        StartUntilWritten("scene.pbrt --noise 1e-6 --checkpoint killed --checkpoint-interval 0.01", "killed");
    kill(pid, SIGKILL);
    Wait(pid);
    ExpectMergeError("none.exr killed", {"killed: ", "unfinished: of a render with", " 0:", "--incomplete"});
    // The first checkpoint is written before the first sample.
    const Outcome some = RunImgtool("merge some.exr --incomplete killed");
    if (some.status == 0) EXPECT_GT(IntOf(ReadImage(Path("some.exr")), "samplesPerPixel"), 0);
    else ExpectWords(some.err, {"killed: has no samples"});
}

TEST_F(Parts, ThatLearnSeparatelyAgreeAsWell) {
    if (!ext_) GTEST_SKIP() << "NOT TESTED: no light sampler of this build learns while it renders";
    Write("scene.pbrt", LearningScene("rgb", 16));
    ExpectSameFromParts(Render(lights_ + "scene.pbrt", "whole.exr"), lights_ + "scene.pbrt", {"3:16", "0:3"});
}

class SharedLights : public Checkpoints {
  protected:
    void SetUp() override {
        Checkpoints::SetUp();
        if (!ext_) GTEST_SKIP() << "NOT TESTED: no light sampler of this build learns";
    }
    /// The scene with the camera moved by x.
    std::string Frame(double x) const {
        return Replaced(LearningScene("rgb", 16), "LookAt 0 1 -5  0 0 0", fmt::format("LookAt {} 1 -5  0 0 0", x));
    }
};

TEST_F(SharedLights, FramesOfAnAnimationChooseTheSameLights) {
    Write("a.pbrt", Frame(0));
    Write("b.pbrt", Frame(1));
    RunWell(lights_ + "a.pbrt --save-lights lights --outfile a.exr");
    const std::string load = lights_ + "--load-lights lights ";
    const ImageFile one = Render(load + "a.pbrt"), two = Render(load + "b.pbrt --nthreads 1");
    EXPECT_TRUE(SamePixels(two, Render(load + "b.pbrt --nthreads 2"))) << "the picture depends on more than the file";
    EXPECT_EQ(IntOf(one, "lightSampler.leaves"), IntOf(two, "lightSampler.leaves"));
    EXPECT_EQ(IntOf(one, "lightSampler.learnedFromShadowRays"), IntOf(two, "lightSampler.learnedFromShadowRays"));
    // The file decides the picture.
    EXPECT_FALSE(SamePixels(two, Render(lights_ + "--render-coord-sys world b.pbrt")));
    // A checkpoint of such a render resumes with the same lights, and with no others.
    RunWell(load + "b.pbrt --checkpoint c.chk --outfile b.exr");
    RunWell(load + "b.pbrt --checkpoint c.chk --resume --spp 20 --outfile b.exr");
    RunWell(lights_ + "b.pbrt --save-lights others --outfile b.exr");
    ExpectErrors({{lights_ + "--load-lights others b.pbrt --checkpoint c.chk --resume", {"--load-lights is"}},
                  {lights_ + "b.pbrt --checkpoint c.chk --resume", {"--load-lights is not given"}}});
}

TEST_F(SharedLights, IncludePortals) {
    Write("a.pbrt", WindowScene("0 0 -1.8", 1, "1 1 1"));
    Write("b.pbrt", WindowScene("1 .2 -1.7", 1, "1 1 1"));
    const std::string octree = "--lightsampler octree:prepassspp=1,portals=always ",
                      load = octree + "--load-lights lights ";
    const ImageFile made = Render(octree + "a.pbrt --save-lights lights"), loaded = Render(load + "a.pbrt"),
                    other = Render(load + "b.pbrt --nthreads 1");
    EXPECT_EQ(IntOf(made, "lightSampler.portals"), 1);
    EXPECT_EQ(IntOf(other, "lightSampler.portals"), 1);
    EXPECT_TRUE(SamePixels(made, loaded)) << "what is read from the file is not what was written";
    EXPECT_TRUE(SamePixels(other, Render(load + "b.pbrt --nthreads 2"))) << "the picture depends on more than the file";
    EXPECT_FALSE(SamePixels(other, Render(octree + "b.pbrt --seed 1")));
}

TEST_F(SharedLights, IncludeTheGuide) {
    Write("a.pbrt", GuidedScene(256));
    Write("b.pbrt", Replaced(GuidedScene(16), "LookAt 0 1.2 -2.8", "LookAt .3 1.2 -2.7"));
    for (const std::string lights : {"--lightsampler octree", "--lightsampler bvh"}) {
        RunWell(lights + " --guide a.pbrt --save-lights lights --outfile a.exr");
        const std::string load = lights + "+guide --load-lights lights ";
        const ImageFile one = Render(load + "b.pbrt --nthreads 1");
        EXPECT_GT(IntOf(one, "guide.guidingCells"), 0);
        EXPECT_GT(IntOf(one, "guide.rouletteCells"), 0);
        EXPECT_TRUE(SamePixels(one, Render(load + "b.pbrt --nthreads 2")));
        ExpectSameFromParts(one, load + "b.pbrt", {"7:16", "0:7"});
        ExpectSameAfterKills(Render(load + "a.pbrt --nthreads 1"), load + "a.pbrt", {SIGKILL, SIGKILL});
        ExpectErrors({{lights + "+guide:share=0.5 --load-lights lights b.pbrt --outfile b.exr",
                       {"lights: ", "guide", "\"share\":0.5"}}});
    }
    // Learned roulette alone takes its part of a guide, but not the other way round.
    RunWell(lights_ + "--guide a.pbrt --save-lights both --outfile a.exr");
    const ImageFile plain = Render(lights_ + "--load-lights both b.pbrt");
    EXPECT_GT(IntOf(plain, "guide.rouletteCells"), 0);
    EXPECT_EQ(IntOf(plain, "guide.guidingCells"), 0);
    RunWell(lights_ + "a.pbrt --save-lights lights --outfile a.exr");
    EXPECT_GT(IntOf(Render(lights_ + "--load-lights lights b.pbrt"), "guide.rouletteCells"), 0);
    ExpectErrors({{lights_ + "--guide --load-lights lights b.pbrt --outfile b.exr",
                   {"lights: ", "guide", "\"directions\":false"}}});
}

TEST_F(SharedLights, ErrorsOfOtherLightsNameTheDifference) {
    Write("a.pbrt", Frame(0));
    Write("more.pbrt", Frame(0) + "LightSource \"point\"\n");
    Write("larger.pbrt", Frame(0) + "Shape \"sphere\" \"float radius\" 20\n");
    Write("brighter.pbrt", Replaced(Frame(0), "[ 2 3 4 ]", "[ 2 3 5 ]"));
    RunWell(lights_ + "a.pbrt --save-lights lights --outfile a.exr");
    const std::string load = "--load-lights lights --outfile b.exr ";
    ExpectErrors(
        {{lights_ + load + "more.pbrt", {"lights: ", "83", "82"}},
         {lights_ + load + "larger.pbrt", {"the scene's bounding box is"}},
         {lights_ + load + "brighter.pbrt", {"the lights' power and places"}},
         {"--lightsampler octree:floor=0.2 " + load + "a.pbrt", {"the light sampler's parameters"}},
         {"--lightsampler bvh " + load + "a.pbrt", {"\"bvh\" learns nothing"}},
         {"--lightsampler bvh --save-lights x a.pbrt --outfile b.exr", {"\"bvh\" learns nothing"}},
         {"--integrator simplepath --save-lights x a.pbrt --outfile b.exr", {"uses no light sampler"}},
         {lights_ + load + "--save-lights ./lights a.pbrt", {"lights: is named by --save-lights and by --load-lights"}},
         {lights_ + "--load-lights none a.pbrt", {"none: there is no such"}}});
    const std::string whole = Read("lights");
    Write("cut", whole.substr(0, whole.size() / 2));
    ExpectErrors({{lights_ + "--load-lights cut a.pbrt", {"cut", "cut off"}}});
}

}  // namespace pbrt::test
