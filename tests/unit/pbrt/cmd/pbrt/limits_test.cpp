#include "program.h"

namespace pbrt::test {

/// Scenes with sizes or numbers beyond the limits: each must end with an error that names the cause, not with a signal
/// or an endless wait.
class Limits : public SmallSceneProgram {
  protected:
    /// Expects that a scene of these directives ends with status 1 and a message. The options begin on line 2.
    void ExpectEnd(const std::string &options, const std::string &world, const std::vector<std::string> &parts) const {
        Write("limit.pbrt", SceneText().Film(16, 16).Head(options).World(Objects().Add(world)));
        ExpectErrors({{"--spp 1 --outfile out.exr limit.pbrt", parts}});
    }
};

TEST_F(Limits, PowerBeyondFloat) {
    // A radiance of 1e25 over an area of 1e30.
    const Objects disk = Objects().Disk(1e15);
    Write("power.pbrt",
          SceneText().Film(4, 4).World(Objects().Light("point").AreaLight("1e25 1e25 1e25").Add(disk).Add(disk)));
    EXPECT_FALSE(Has(RunWell("--spp 1 --outfile out.exr power.pbrt"), "Warning"));
}

TEST_F(Limits, PlacesAndRadiance) {
    ExpectEnd("", "LightSource 'infinite' 'rgb L' [ 3e38 1 1 ]", {"a component is above 1e+30"});
    ExpectEnd("", "AreaLightSource 'diffuse' Scale 1 1 1e20 Shape 'cylinder'",
              {"Error: limit.pbrt:3:", "reaches to", "at most 1e+18"});
    ExpectEnd("", "ObjectBegin 'o' Shape 'cylinder' ObjectEnd Scale 1 1 1e20 ObjectInstance 'o'",
              {"the instance of \"o\" reaches to"});
    ExpectEnd("",
              "ObjectBegin 'o' Shape 'disk' ObjectEnd ObjectInstance 'o'\n"
              "AttributeBegin Scale 1 1 0 ObjectInstance 'o' AttributeEnd\n"
              "ConcatTransform [ 1 0 4294967295 0  0 1 0 0  0 0 1 0  -1 1 0 1 ] ObjectInstance 'o'",
              {"Error: limit.pbrt:5:", "too far", "^"});
    ExpectEnd("Scale 1e-30 1e-30 1e-30 Translate 0 0 -1e30 Camera 'perspective'", "Shape 'sphere'",
              {"Camera reaches to"});
    ExpectEnd("Scale 0 1 1 Camera 'perspective'", "Shape 'sphere'", {"cannot be inverted"});
}

TEST_F(Limits, WhatDoesNotFitIntoMemory) {
    ExpectEnd("Film 'rgb' 'integer xresolution' 1000000 'integer yresolution' 1000000", "Shape 'sphere'",
              {"Error: limit.pbrt:2:", "1000000 x 1000000 pixels", "76 TB"});
    ExpectEnd("PixelFilter 'gaussian' 'float xradius' 1e9", "Shape 'sphere'", {"at most 1000"});
    // Where the memory cannot be estimated in advance, the message names what needed the memory.
    for (const char *kilobytes : {"150000", "300000", "600000"}) {
        const Outcome o =
            Wait(Start("--quiet --spp 1 --outfile out.exr scene.pbrt", std::string("ulimit -v ") + kilobytes));
        if (o.status == 0) continue;  // this much memory was enough
        EXPECT_EQ(o.status, 1) << kilobytes << o.err;
        ExpectWords(o.err, {"enough memory"});
    }
}

TEST_F(Limits, MemoryIsEstimatedBeforeBuildingAndLimited) {
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
