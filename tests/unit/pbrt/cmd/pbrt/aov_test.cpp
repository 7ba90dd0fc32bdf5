// --aov as a user runs it.
#include "program.h"

namespace pbrt::test {

namespace {

std::string SceneOf(const std::string &film, const std::string &integrator = "path") {
    return Replaced(Replaced(SmallScene(), "rgb", film), "path", integrator);
}

/// Expects equal bits of the channels that are in both pictures; returns how many there are.
int SharedChannels(const Image &a, const Image &b) {
    int shared = 0;
    for (const std::string &name : a.Channels()) {
        if (b.FindChannel(name) < 0) continue;
        ++shared;
        EXPECT_TRUE(SamePixels({a.Select({name}), {}}, {b.Select({name}), {}})) << name;
    }
    return shared;
}

}  // namespace

class AovFlag : public Program {};

TEST_F(AovFlag, TheColoursKeepTheirBitsWithEveryFilmAndIntegrator) {
    for (const std::string &scene : {SceneOf("rgb"), SceneOf("gbuffer"), SceneOf("spectral"), SceneOf("rgb", "volpath"),
                                     SceneOf("rgb", "simplepath"), SceneOf("rgb", "randomwalk"),
                                     Replaced(SceneOf("rgb", "ambientocclusion"), "\"integer maxdepth\" 3", "")}) {
        SCOPED_TRACE(scene);
        Write("scene.pbrt", scene);
        const Image plain = Render("scene.pbrt").image;
        const Image more = Render("--aov albedo,normal,geonormal,position,depth,uv scene.pbrt").image;
        EXPECT_EQ(SharedChannels(plain, more), plain.ChannelCount());
        for (const char *name : {"Albedo.R", "Ns.X", "N.Z", "P.Y", "Z", "u", "v"})
            EXPECT_GE(more.FindChannel(name), 0) << name;
    }
}

TEST_F(AovFlag, ChannelsAreThoseOfTheGBufferFilm) {
    Write("rgb.pbrt", SceneOf("rgb"));
    Write("gbuffer.pbrt", SceneOf("gbuffer"));
    const Image gbuffer = Render("gbuffer.pbrt").image;
    const Image added = Render("--aov uv,albedo,normal,geonormal,position rgb.pbrt").image;
    EXPECT_EQ(SharedChannels(added, gbuffer), 3 + 3 * 4 + 2);
    EXPECT_EQ(added.ChannelCount(), 3 + 3 * 4 + 2);
    const Image depth = Render("--aov depth rgb.pbrt").image;
    for (int x = 0; x < 32; ++x)
        EXPECT_EQ(depth.Get({x, 12}, depth.FindChannel("Z")), gbuffer.Get({x, 12}, gbuffer.FindChannel("P.Z")));
    // The ball is red, and its normal in the middle of the picture looks at the camera.
    const int albedo = added.FindChannel("Albedo.R"), normal = added.FindChannel("Ns.X");
    EXPECT_NEAR(added.Get({16, 12}, albedo), 0.6f, 0.1f);
    EXPECT_LT(added.Get({16, 12}, normal + 2), -0.9f);
    EXPECT_EQ(added.Get({0, 0}, albedo), 0);
}

TEST_F(AovFlag, PartsAndCheckpointsKeepTheChannels) {
    Write("scene.pbrt", SceneOf("rgb"));
    const std::string arguments = "--aov normal,albedo scene.pbrt ";
    const Image whole = Render(arguments).image;
    RunWell(arguments + "--samples 0:1 --checkpoint a.part");
    RunWell(arguments + "--samples 1:4 --checkpoint b.part");
    EXPECT_EQ(SharedChannels(whole, Merged("m.exr b.part a.part").image), 9);
    RunWell(arguments + "--checkpoint c.chk --outfile c.exr");
    ExpectErrors({{"scene.pbrt --aov normal --checkpoint c.chk --resume --outfile c.exr", {"--aov"}}});
}

TEST_F(AovFlag, MistakesNameTheChoices) {
    Write("scene.pbrt", SceneOf("rgb"));
    ExpectErrors({{"--aov albdo scene.pbrt", {"--aov", "albdo", "albedo", "geonormal"}},
                  {"--aov albedo --outfile a.png scene.pbrt", {"--aov", "a.png", ".exr"}}});
}

}  // namespace pbrt::test
