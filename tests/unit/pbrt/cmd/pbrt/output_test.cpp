// Tests where the picture is written, and what happens if it cannot be written.
#include <sys/stat.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "program.h"
#include "support/small_files.h"

namespace pbrt::test {

class Output : public SmallSceneProgram {};

TEST_F(Output, AFullDiskIsAnErrorAndKeepsTheOldPicture) {
    for (const std::string name : {"out.exr", "out.png", "out.pfm"}) {
        Write(name, "an old picture");
        {
            const SmallFilesOnly limit(1000);
            ExpectErrors(
                {{"--spp 1 --outfile " + name + " scene.pbrt", {name + ": cannot be written: File too large"}}});
        }
        EXPECT_EQ(Read(name), "an old picture");
        RunWell("--spp 1 --outfile " + name + " scene.pbrt");
        EXPECT_GT(Read(name).size(), 1000u) << "the picture is too small for the limit of this test";
    }
}

// The folder of the picture vanishes during the render, and for the second render that of the scene as well.
TEST_F(Output, AFinishedRenderIsNeverLost) {
    const bool ext = HasExt();
    for (const std::string rescuedIn : {"scenes/", ""}) {
        SCOPED_TRACE(rescuedIn);
        Write("scenes/scene.pbrt", LearningScene("rgb", 1024));
        std::filesystem::create_directory(Path("pictures"));
        std::filesystem::remove(Path("c.chk"));
        const pid_t pid = StartUntilWritten(
            std::string("--outfile pictures/out.exr --stats=json --checkpoint c.chk --checkpoint-interval 0.01 ") +
                (ext ? "--lightsampler octree --save-lights lights " : "") + "scenes/scene.pbrt",
            "c.chk");
        std::filesystem::remove_all(Path("pictures"));
        if (rescuedIn.empty()) std::filesystem::remove_all(Path("scenes"));
        const Outcome o = Wait(pid);
        EXPECT_EQ(o.status, 1);
        const std::string name = fmt::format("{}out-rescued-{}.exr", rescuedIn, pid);
        ExpectWords(o.err, {"Error: pictures/out.exr: the folder pictures does not exist",
                            "pictures/out.exr: this image is in " + name});
        EXPECT_FALSE(Has(o.err, "nothing was rendered")) << o.err;
        EXPECT_EQ(IntOf(ReadImage(Path(name)), "samplesPerPixel"), 1024);
        EXPECT_EQ(nlohmann::json::parse(o.out)["picture"], name);
        EXPECT_TRUE(!ext || Exists("lights"));
    }
}

TEST_F(Output, PicturesOfStrategiesStandBesideThePicture) {
    Write("scene.pbrt", Replaced(SmallScene(), Quoted("'path' 'integer maxdepth' 3"),
                                 Quoted("'bdpt' 'bool visualizestrategies' true 'bool visualizeweights' true "
                                        "'integer maxdepth' 2")));
    RunWell("--spp 2 --outfile out.exr scene.pbrt");
    std::vector<std::string> expected = {"out.exr", "scene.pbrt"};
    for (const char *kind : {"strategy", "weighted"})
        for (const char *strategy : {"depth0-s0-t2", "depth1-s0-t3", "depth1-s1-t2", "depth1-s2-t1", "depth2-s0-t4",
                                     "depth2-s1-t3", "depth2-s2-t2", "depth2-s3-t1"})
            expected.push_back(std::string("out-") + kind + "-" + strategy + ".exr");
    std::sort(expected.begin(), expected.end());
    EXPECT_EQ(Files(), expected);
    EXPECT_EQ(ReadImage(Path("out-weighted-depth1-s1-t2.exr")).image.Resolution(), Point2i(32, 24));
    ExpectErrors({{"--checkpoint c.chk --outfile other.exr scene.pbrt", {"visualizestrategies", "--checkpoint"}},
                  {"--checkpoint c.chk --samples 0:1 scene.pbrt", {"visualizestrategies", "--samples"}}});
}

TEST_F(Output, NamesMayBeLongAndInCapitals) {
    for (const std::string &name : {std::string(248, 'n') + ".exr", std::string("OUT.EXR"), std::string("out.Png")}) {
        RunWell("--spp 1 --outfile " + name + " scene.pbrt");
        EXPECT_EQ(ReadImage(Path(name)).image.Resolution(), Point2i(32, 24)) << name;
    }
    // The error must come before rendering, which would take hours.
    ExpectErrors({{"--spp 100000000 --outfile " + std::string(252, 'n') + ".exr scene.pbrt", {"File name too long"}}});
}

// The second of two outputs would replace the first, and a render would replace its own scene.
TEST_F(Output, OneFileIsNotWrittenForTwoThingsNorOverAnInput) {
    Write("part.pbrt", "# nothing\n");
    Write("whole.pbrt", SmallScene() + Quoted("Include 'part.pbrt'\n"));
    Write("picture.exr", "a picture");
    Write("image.pbrt",
          SmallScene() + Quoted("Texture 'wood' 'spectrum' 'imagemap' 'string filename' 'picture.exr'\n"));
    Write("log.pbrt", Quoted("Option 'msereferenceimage' 'picture.exr'\nOption 'msereferenceout' './picture.exr'\n") +
                          SmallScene());
    std::filesystem::create_symlink("scene.pbrt", Path("link"));
    std::filesystem::create_directory(Path("folder"));
    ExpectErrors(
        {{"--outfile a.exr --save-lights a.exr scene.pbrt", {"a.exr: ", "--outfile", "--save-lights"}},
         {"--outfile a.exr --checkpoint ./folder/../a.exr scene.pbrt", {"a.exr: ", "--outfile", "--checkpoint"}},
         {"--checkpoint c --save-lights c scene.pbrt", {"c: ", "--checkpoint", "--save-lights"}},
         {"--save-lights scene.exr scene.pbrt", {"scene.pbrt:3:", "scene.exr: ", "--save-lights", "Film", "^"}},
         {"--save-lights scene.pbrt scene.pbrt", {"scene.pbrt: ", "--save-lights", "the scene"}},
         {"--save-lights link scene.pbrt", {"link: ", "--save-lights", "the scene"}},
         {"--samples 0:1 --checkpoint c --mse-reference-image picture.exr --mse-reference-out picture.exr scene.pbrt",
          {"picture.exr: ", "--mse-reference-out", "--mse-reference-image"}},
         {"--mse-reference-image picture.exr --mse-reference-out part.pbrt whole.pbrt",
          {"part.pbrt: ", "--mse-reference-out", "the scene"}},
         {"log.pbrt", {"log.pbrt:2:7: ", "picture.exr: ", "msereferenceout", "msereferenceimage", "^"}},
         {"--outfile picture.exr image.pbrt",
          {"image.pbrt:", "picture.exr: ", "--outfile", "Texture \"imagemap\"", "^"}}});
    EXPECT_EQ(Read("scene.pbrt"), SmallScene());
    EXPECT_EQ(Read("picture.exr"), "a picture");
    EXPECT_EQ(Read("part.pbrt"), "# nothing\n");
}

TEST_F(Output, GoesIntoPipes) {
    ASSERT_EQ(mkfifo(Path("pipe.pfm").c_str(), 0600), 0);
    const pid_t pid = Start("--quiet --spp 1 --outfile pipe.pfm scene.pbrt");
    const std::string bytes = Read("pipe.pfm");
    EXPECT_EQ(Wait(pid).status, 0);
    EXPECT_TRUE(std::filesystem::is_fifo(Path("pipe.pfm")));
    EXPECT_TRUE(bytes.starts_with("PF\n32 24\n")) << bytes.size();
    EXPECT_EQ(bytes.size(), 12u + 32 * 24 * 12);
}

// The program must neither wait for a pipe nor read a device for ever.
TEST_F(Output, PipesAndDevicesAreNoAssets) {
    ASSERT_EQ(mkfifo(Path("pipe.png").c_str(), 0600), 0);
    std::filesystem::create_symlink("/dev/zero", Path("zero.exr"));
    Write("include.pbrt", Quoted("Include 'pipe.png'\n"));
    Write("zero.pbrt", SceneText().World("Include '/dev/zero'\n"));
    Write("texture.pbrt", SceneText().World(Objects()
                                                .Add("Texture 't' 'spectrum' 'imagemap' 'string filename' 'pipe.png'")
                                                .Add("Texture 'u' 'spectrum' 'imagemap' 'string filename' 'zero.exr'")
                                                .Material("diffuse", "'texture reflectance' 't'")
                                                .Sphere()
                                                .Material("diffuse", "'texture reflectance' 'u'")
                                                .Sphere()));
    Write("ply.pbrt", SceneText().World(Objects().Shape("plymesh", "'string filename' 'pipe.png'")));
    ExpectErrors({{"include.pbrt", {"include.pbrt:1", "is a pipe"}},
                  {"zero.pbrt", {"zero.pbrt:2", "/dev/zero: is a device"}},
                  {"texture.pbrt", {"pipe.png: is a pipe"}},
                  {"ply.pbrt", {"pipe.png: is a pipe"}},
                  {"/dev/zero", {"is a device"}}});
}

}  // namespace pbrt::test
