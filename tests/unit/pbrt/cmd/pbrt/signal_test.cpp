// Tests what Ctrl-C, SIGTERM and SIGHUP do in every phase of a render, and which files they leave.
#include <signal.h>
#include <sys/stat.h>

#include "pbrt/core/progress.h"
#include "program.h"

namespace pbrt::test {

namespace {

/// A scene of a quarter of a million emitting triangles, among which light sampling by "exhaustive" takes many
/// milliseconds per sample: the first wave of 256 x 256 pixels would take a quarter of an hour, a single tile of it
/// seconds.
std::string SlowScene() {
    return SceneText()
        .LookAt("0 1 -5  0 0 0  0 1 0")
        .Camera(40)
        .Film(256, 256, "'string filename' 'out.exr'")
        .Integrator("path", 5, "'string lightsampler' 'exhaustive'")
        .World(Objects()
                   .Quad("-4 -1 -4  4 -1 -4  -4 -1 4  4 -1 4")
                   .Add("AreaLightSource 'diffuse'")
                   .Shape("loopsubdiv",
                          "'integer levels' 8 'integer indices' [ 0 1 2  0 2 3  0 3 1  1 3 2 ] "
                          "'point3 P' [ 0 3 0  1 2 0  -1 2 1  -1 2 -1 ]"));
}

constexpr int kSignals[] = {SIGINT, SIGTERM, SIGHUP};

/// Over the first three channels.
double ChannelSum(const Image &image) {
    double sum = 0;
    ForEachPixel(image, [&](Point2i p) {
        for (int c = 0; c < 3; ++c) sum += double(image.Get(p, c));
    });
    return sum;
}

}  // namespace

class Signals : public SmallSceneProgram {
  protected:
    /// Sends the signal and expects the program to end within seconds, although its work would take minutes or for
    /// ever.
    Outcome End(pid_t pid, int signal) const {
        const auto start = std::chrono::steady_clock::now();
        kill(pid, signal);
        const Outcome o = Wait(pid);
        EXPECT_LT(SecondsSince(start), 5);
        EXPECT_EQ(o.status, 128 + signal) << o.err;
        ExpectWords(o.err, {"Interrupted"});
        EXPECT_FALSE(Has(o.err, "Error")) << o.err;
        return o;
    }

    /// Expects that each signal, sent when the program has printed `message`, ends it with these words and without a
    /// picture.
    void ExpectNothingWritten(const std::string &message, const std::string &arguments,
                              const std::vector<std::string> &words) const {
        const std::vector<std::string> before = Files();
        for (int signal : kSignals) {
            const pid_t pid = Start("--outfile out.exr " + arguments);
            EXPECT_TRUE(WaitUntil([&] { return Has(Messages(pid), message); })) << Messages(pid);
            const Outcome o = End(pid, signal);
            ExpectWords(o.err, words);
            EXPECT_FALSE(Has(o.err, "Wrote")) << o.err;
        }
        EXPECT_EQ(Files(), before);
    }

    /// Starts a render without end, and interrupts it after its first wave.
    Outcome EndWhileRendering(int signal, const std::string &name = "out.exr") const {
        if (!Exists("logged/reference.exr")) {
            std::filesystem::create_directory(Path("logged"));
            Render("--spp 1 scene.pbrt", "logged/reference.exr");
        }
        std::filesystem::remove(Path("logged/mse.txt"));
        const pid_t pid = Start(
            "--spp 100000000 --mse-reference-image logged/reference.exr --mse-reference-out logged/mse.txt "
            "scene.pbrt --outfile " +
            name);
        // The first line of the log means that a wave is done.
        EXPECT_TRUE(WaitUntil([&] { return !Read("logged/mse.txt").empty(); })) << Messages(pid);
        return End(pid, signal);
    }
    static void ExpectInterrupted(const ImageFile &file) { EXPECT_EQ(IntOf(file, "pbrt.interrupted"), 1); }

    /// Writes out.exr with these values in its header and pixels that no render here would give; returns its bytes.
    std::string WriteOld(int samples, const std::string &scene) const {
        ImageFile old{Image(PixelFormat::Float, {32, 24}, {"R", "G", "B"}), {}};
        old.image.Set({3, 3}, 1, 1234);
        old.metadata.attributes["samplesPerPixel"] = samples;
        old.metadata.attributes["pbrt.scene"] = scene;
        old.metadata.attributes["pbrt.integrator"] = std::string("path");
        WriteImage(Path("out.exr"), old.image, old.metadata);
        return Read("out.exr");
    }
};

TEST_F(Signals, WhileASceneIsAwaited) {
    ASSERT_EQ(mkfifo(Path("pipe").c_str(), 0600), 0);
    for (int signal : kSignals) {
        // The scene is a pipe without writer, given by name, or an open, silent one as standard input.
        for (const char *arguments : {"--outfile out.exr pipe", "--outfile out.exr - <> pipe"}) {
            const pid_t pid = Start(arguments);
            EXPECT_TRUE(WaitUntil([&] { return HandlesSignals(pid); }));
            ExpectWords(End(pid, signal).err, {"no image"});
        }
    }
    EXPECT_EQ(Files(), (std::vector<std::string>{"pipe", "scene.pbrt"}));
}

TEST_F(Signals, WhileBuilding) {
    // Subdivision makes some eight million triangles.
    Write("big.pbrt", SceneText()
                          .Head("Film 'rgb'")
                          .World(Objects().Shape(
                              "loopsubdiv",
                              "'integer levels' 10 'integer indices' [ 0 1 2  0 2 3  0 3 1  1 3 2  4 5 6  4 6 7 ] "
                              "'point3 P' [ 0 3 0  1 2 0  -1 2 1  -1 2 -1  9 3 0  9 2 0  9 2 1  8 2 -1 ]")));
    ExpectNothingWritten("reading: done", "big.pbrt", {"while building", "no image"});
}

TEST_F(Signals, WhilePreparingLights) {
    PBRT_SKIP_WITHOUT_EXT();
    ExpectNothingWritten("building: done",
                         "--lightsampler octree:prepassspp=1024,depth=64 --maxdepth 64 " PBRT_SOURCE_DIR
                         "/scenes/dollhouse/dollhouse.pbrt",
                         {"while preparing lights", "no image"});
}

TEST_F(Signals, InTheFirstWaveNothingIsWrittenAndTheOldImageStays) {
    Write("slow.pbrt", SlowScene());
    const std::string before = WriteOld(1, "another.pbrt");
    ExpectNothingWritten("preparing lights: done", "slow.pbrt", {"no image"});
    EXPECT_EQ(Read("out.exr"), before);
}

TEST_F(Signals, WhileRenderingSaveWhatWasRendered) {
    for (int signal : kSignals) {
        ExpectWords(EndWhileRendering(signal).err, {"Wrote out.exr"});
        const ImageFile file = ReadImage(Path("out.exr"));
        ExpectInterrupted(file);
        EXPECT_GE(IntOf(file, "samplesPerPixel"), 1);
        EXPECT_GT(ChannelSum(file.image.Crop({{0, 20}, {32, 21}})), 0);
        std::filesystem::remove(Path("out.exr"));
        EXPECT_EQ(Files(), (std::vector<std::string>{"logged", "scene.pbrt"}));
    }
}

TEST_F(Signals, WhatIsSavedIsAnUnbiasedPictureInEveryFilm) {
    for (const char *film : {"rgb", "gbuffer", "spectral"}) {
        Write("scene.pbrt", Replaced(SmallScene(), "rgb", film));
        const ImageFile whole = Render("--spp 256 scene.pbrt", "whole.exr");
        std::filesystem::remove_all(Path("logged"));
        EndWhileRendering(SIGINT);
        const ImageFile part = ReadImage(Path("out.exr"));
        EXPECT_EQ(part.image.Channels(), whole.image.Channels());
        // With one sample per pixel this mean has 2 % of noise; pixels divided by samples that they never got would
        // lose half of the light.
        EXPECT_NEAR(ChannelSum(part.image) / ChannelSum(whole.image), 1, 0.15) << film;
        std::filesystem::remove(Path("out.exr"));
    }
}

TEST_F(Signals, ABetterPictureOfTheSceneIsKept) {
    const std::string before = WriteOld(2000000000, "scene.pbrt");
    ExpectWords(EndWhileRendering(SIGTERM).err, {"Wrote out-unfinished.exr", "out.exr is kept"});
    EXPECT_EQ(Read("out.exr"), before);
    ExpectInterrupted(ReadImage(Path("out-unfinished.exr")));
    EXPECT_EQ(Files(), (std::vector<std::string>{"logged", "out-unfinished.exr", "out.exr", "scene.pbrt"}));
}

TEST_F(Signals, AWorsePictureOrOneOfAnotherSceneIsReplaced) {
    for (auto [samples, scene] : {std::pair(0, "scene.pbrt"), std::pair(2000000000, "another.pbrt")}) {
        WriteOld(samples, scene);
        EndWhileRendering(SIGINT);
        ExpectInterrupted(ReadImage(Path("out.exr")));
        EXPECT_EQ(Files(), (std::vector<std::string>{"logged", "out.exr", "scene.pbrt"})) << scene;
    }
}

TEST_F(Signals, AnImageWithoutItsSampleCountIsKept) {
    for (const std::string extension : {".png", ".pfm"}) {
        const std::string name = "out" + extension;
        Render("--spp 2 scene.pbrt", name);
        const std::string before = Read(name);
        EndWhileRendering(SIGINT, name);
        EXPECT_EQ(Read(name), before);
        EXPECT_TRUE(Exists("out-unfinished" + extension));
    }
}

TEST_F(Signals, AFinishedRenderReplacesWhateverThereWas) {
    WriteOld(2000000000, "scene.pbrt");
    // The partial pictures do not replace out.exr, and they leave no files behind.
    EXPECT_EQ(IntOf(Render("--spp 16 --write-partial-images scene.pbrt"), "samplesPerPixel"), 16);
    EXPECT_EQ(Files(), (std::vector<std::string>{"out.exr", "scene.pbrt"}));
}

TEST_F(Signals, PartialPicturesShowTheWavesSoFarAndLeaveABetterOneAlone) {
    const std::string before = WriteOld(2000000000, "scene.pbrt");
    const pid_t pid =
        StartUntilWritten("--spp 100000000 --write-partial-images --outfile out.exr scene.pbrt", "out-unfinished.exr");
    EXPECT_EQ(Read("out.exr"), before);
    const ImageFile partial = ReadImage(Path("out-unfinished.exr"));
    EXPECT_GE(IntOf(partial, "samplesPerPixel"), 1);
    EXPECT_LT(IntOf(partial, "samplesPerPixel"), 100000000);
    EXPECT_GT(NumberOf(partial, "renderTimeSeconds"), 0);
    EXPECT_FALSE(partial.metadata.attributes.contains("pbrt.interrupted"));
    End(pid, SIGINT);
    EXPECT_EQ(Read("out.exr"), before);
    const ImageFile last = ReadImage(Path("out-unfinished.exr"));
    ExpectInterrupted(last);
    EXPECT_GE(IntOf(last, "samplesPerPixel"), IntOf(partial, "samplesPerPixel"));
    EXPECT_EQ(Files(), (std::vector<std::string>{"out-unfinished.exr", "out.exr", "scene.pbrt"}));
}

TEST_F(Signals, APartialPictureThatCannotBeWrittenEndsNothing) {
    std::filesystem::create_directory(Path("folder"));
    const pid_t pid = StartUntilWritten("--spp 100000000 --write-partial-images --outfile folder/out.exr scene.pbrt",
                                        "folder/out.exr");
    std::filesystem::rename(Path("folder"), Path("away"));
    EXPECT_TRUE(WaitUntil([&] { return Has(Messages(pid), "was not written; rendering continues."); }))
        << Messages(pid);
    std::filesystem::rename(Path("away"), Path("folder"));
    ExpectWords(End(pid, SIGINT).err, {"Wrote folder/out.exr"});
}

TEST_F(Signals, AClosedPipeEndsNoRender) {
    EXPECT_EQ(Run("--spp 2 --stats --outfile out.exr scene.pbrt 2>&1 | true").status, 0);
    EXPECT_TRUE(WaitUntil([&] { return Exists("out.exr"); }));
}

}  // namespace pbrt::test
