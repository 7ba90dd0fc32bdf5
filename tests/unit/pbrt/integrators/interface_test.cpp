#include <gtest/gtest.h>

#include "support/render_scene.h"
#include "support/scene_text.h"

namespace pbrt::test {
namespace {

const std::string kPointLamp = Objects().PointLight("0 0 0", "9 9 9"),
                  kBallLamp = Objects().AreaLight("5 5 5").Sphere(.4);

const std::string kTetrahedron =
    " 'point3 P' [ -1 -1 -.7  1 -1 -.7  0 1 -.7  0 0 1 ] 'integer indices' [ 0 2 1  0 1 3  1 2 3  2 0 3 ]\n";
/// Closed surfaces around the origin, one for each way in which the program traces rays.
const std::vector<std::string> kShells = {
    "Shape 'sphere' 'float radius' .7\n",
    "Shape 'sphere' 'float radius' .7 'float alpha' .5\n",
    "Shape 'trianglemesh'" + kTetrahedron,
    "Shape 'trianglemesh' 'float alpha' .5" + kTetrahedron,
    "ObjectBegin 'shell' Shape 'sphere' 'float radius' .7 ObjectEnd Identity ObjectInstance 'shell'\n",
};

/// A floor and a ball under a lamp; a shape of the material "interface" is around the lamp or around the ball.
std::string ShellScene(const std::string &integrator, const std::string &lamp, const std::string &aroundLamp,
                       const std::string &aroundBall, int samples) {
    const auto shell = [](const std::string &shape) {
        return shape.empty() ? "" : "AttributeBegin Material 'interface'\n" + shape + "AttributeEnd\n";
    };
    return SceneText()
        .LookAt("0 -5 3  0 0 .7  0 0 1")
        .Camera(40)
        .Film(12, 12)
        .Filter("box")
        .Samples(samples)
        .Integrator(integrator, 3)
        .World(Objects()
                   .Triangles("-4 -4 -.4  4 -4 -.4  4 4 -.4  -4 4 -.4")
                   .Sphere(.3)
                   .Add(shell(aroundBall) + "Translate 0 0 1.8\n" + shell(aroundLamp) + lamp));
}

double RenderedMean(const std::string &text) { return ChannelStatistics(RenderText(text).image).mean; }

TEST(Interface, VolpathRendersTheSceneWithoutTheShell) {
    for (const std::string &lamp : {kPointLamp, kBallLamp}) {
        // The random numbers are the same, so the pictures differ by rounding only.
        auto mean = [&](const std::string &aroundLamp, const std::string &aroundBall) {
            return RenderedMean(ShellScene("volpath", lamp, aroundLamp, aroundBall, 16));
        };
        const double bare = mean("", "");
        EXPECT_GT(bare, .01);
        for (const std::string &shell : kShells) {
            EXPECT_NEAR(mean(shell, "") / bare, 1, 2e-3) << lamp << shell;
            EXPECT_NEAR(mean("", shell) / bare, 1, 2e-3) << lamp << shell;
        }
    }
}

TEST(Interface, BlocksShadowRaysOfPath) {
    for (const std::string &shell : kShells) {
        const bool holes = shell.find("alpha") != std::string::npos;
        const double mean = RenderedMean(ShellScene("path", kPointLamp, shell, "", 16));
        EXPECT_EQ(mean > 0, holes) << shell << mean;
    }
    // A lamp that rays can meet is still found by BSDF samples, with all of its light.
    const RunningStatistics inside = MeansOverSeeds(ShellScene("path", kBallLamp, kShells[0], "", 256)),
                            bare = MeansOverSeeds(ShellScene("path", kBallLamp, "", "", 64));
    const double error = std::hypot(inside.StandardError(), bare.StandardError());
    EXPECT_LT(std::abs(inside.mean - bare.mean), 5 * error) << inside.mean << " for " << bare.mean;
    EXPECT_LT(error, .02 * bare.mean);
}

TEST(Interface, TheIntegratorOfTheCommandLineDecides) {
    BuildOptions path, volpath;
    path.integrator = "path";
    volpath.integrator = "volpath";
    auto render = [&](const char *integrator, const BuildOptions &options) {
        return RenderText(ShellScene(integrator, kPointLamp, "", kShells[0], 2), options).image;
    };
    const Image dark = render("path", {}), bright = render("volpath", {});
    EXPECT_FALSE(SameBits(dark, bright));
    EXPECT_TRUE(SameBits(dark, render("volpath", path)));
    EXPECT_TRUE(SameBits(bright, render("path", volpath)));
}

}  // namespace
}  // namespace pbrt::test
