#include "program.h"

namespace pbrt::test {

/// Scenes with sizes or numbers beyond the limits: each must end with an error that names the cause, not with a signal
/// or an endless wait.
class Limits : public Program {
  protected:
    struct Case {
        std::string name, options, world;
        std::vector<std::string> parts;  ///< parts of the message
    };
    /// Expects that each scene ends with status 1 and a message.
    void ExpectAll(const std::vector<Case> &cases) const {
        std::vector<ErrorCase> runs;
        for (const Case &c : cases) {
            Write(c.name + ".pbrt", "Film \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 16\n" + c.options +
                                        "\nWorldBegin\n" + c.world + "\n");
            runs.push_back({"--spp 1 --outfile out.exr " + c.name + ".pbrt", c.parts});
        }
        for (const ErrorCase &run : runs) ExpectErrors({run});  // one after the other, because each may use all memory
    }
};

TEST_F(Limits, PowerBeyondFloat) {
    // A radiance of 1e25 over an area of 1e30.
    Write("power.pbrt",
          "Film \"rgb\" \"integer xresolution\" 4 \"integer yresolution\" 4\nWorldBegin\nLightSource \"point\"\n"
          "AreaLightSource \"diffuse\" \"rgb L\" [ 1e25 1e25 1e25 ]\nShape \"disk\" \"float radius\" 1e15\n"
          "Shape \"disk\" \"float radius\" 1e15\n");
    EXPECT_FALSE(Has(RunWell("--spp 1 --outfile out.exr power.pbrt"), "Warning"));
}

TEST_F(Limits, PlacesAndRadiance) {
    ExpectAll({{"bright", "", "LightSource \"infinite\" \"rgb L\" [ 3e38 1 1 ]", {"a component is above 1e+30"}},
               {"scale",
                "",
                "AreaLightSource \"diffuse\" Scale 1 1 1e20 Shape \"cylinder\"",
                {"Error: scale.pbrt:4:", "reaches to", "at most 1e+18"}},
               {"instance",
                "",
                "ObjectBegin \"o\" Shape \"cylinder\" ObjectEnd Scale 1 1 1e20 ObjectInstance \"o\"",
                {"the instance of \"o\" reaches to"}},
               {"reach",
                "",
                "ObjectBegin \"o\" Shape \"disk\" ObjectEnd ObjectInstance \"o\"\n"
                "AttributeBegin Scale 1 1 0 ObjectInstance \"o\" AttributeEnd\n"
                "ConcatTransform [ 1 0 4294967295 0  0 1 0 0  0 0 1 0  -1 1 0 1 ] ObjectInstance \"o\"",
                {"Error: reach.pbrt:6:", "too far", "^"}},
               {"camera",
                "Scale 1e-30 1e-30 1e-30 Translate 0 0 -1e30 Camera \"perspective\"",
                "Shape \"sphere\"",
                {"Camera reaches to"}},
               {"flat", "Scale 0 1 1 Camera \"perspective\"", "Shape \"sphere\"", {"cannot be inverted"}}});
}

TEST_F(Limits, WhatDoesNotFitIntoMemory) {
    ExpectAll({{"film",
                "Film \"rgb\" \"integer xresolution\" 1000000 \"integer yresolution\" 1000000",
                "Shape \"sphere\"",
                {"Error: film.pbrt:2:", "a picture of 1000000 x 1000000 pixels needs about 76 TB of memory"}},
               {"radius", "PixelFilter \"gaussian\" \"float xradius\" 1e9", "Shape \"sphere\"", {"at most 1000"}}});
    // Where the memory cannot be estimated in advance, the message says what there was not enough memory for.
    Write("scene.pbrt", SmallScene());
    for (const char *kilobytes : {"150000", "300000", "600000"}) {
        const Outcome o =
            Wait(Start("--quiet --spp 1 --outfile out.exr scene.pbrt", std::string("ulimit -v ") + kilobytes));
        if (o.status == 0) continue;  // this much memory was enough
        EXPECT_EQ(o.status, 1) << kilobytes << o.err;
        EXPECT_TRUE(Has(o.err, "enough memory")) << kilobytes << o.err;
    }
}

TEST_F(Limits, MemoryIsEstimatedBeforeBuildingAndLimited) {
    Write("scene.pbrt", SmallScene());
    // The head of a mesh that is never read.
    Write(
        "big.ply",
        "ply\nformat binary_little_endian 1.0\nelement vertex 100000000\nproperty float x\nproperty float y\n"
        "property float z\nproperty float nx\nelement face 200000000\nproperty list uchar int vertex_indices\nend_header\n");
    Write("big.pbrt", SmallScene() + "Shape \"plymesh\" \"string filename\" \"big.ply\"\n");
    ExpectErrors({{"--memory-limit 2000 --outfile out.exr big.pbrt",
                   {"big.pbrt:", "Shape \"plymesh\"", "at least 1", " GB: meshes 1",
                    "(200 million triangles), film 0.0 MB", "2.0 GB"}},
                  {"--memory-limit 0 big.pbrt", {"--memory-limit"}},
                  {"--memory-limit 1 --outfile out.exr scene.pbrt", {"enough memory"}},
                  {"--memory-limit 20 --outfile out.exr scene.pbrt", {"enough memory", "20 MB", "--memory-limit"}}});
    EXPECT_EQ(Run("--memory-limit 2000 --outfile out.exr scene.pbrt").status, 0);
}

}  // namespace pbrt::test
