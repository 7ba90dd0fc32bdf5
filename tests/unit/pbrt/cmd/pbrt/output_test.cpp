// Tests where the picture is written, and what happens if it cannot be written.
#include <sys/stat.h>

#include <algorithm>

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
