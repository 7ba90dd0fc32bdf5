#include <gtest/gtest.h>

#include "support/render_scene.h"
#include "support/scene_text.h"

namespace pbrt::test {
namespace {

/// A floor under a lamp that the camera sees, directly and in a mirror.
std::string MirrorScene(const std::string &integrator) {
    return SceneText()
        .LookAt("0 -6 1.5  0 0 1.2  0 0 1")
        .Camera(40)
        .Film(24, 24)
        .Filter("box")
        .Samples(16)
        .Integrator(integrator, 3)
        .World(Objects()
                   .Triangles("-4 -4 0  4 -4 0  4 4 0  -4 4 0")
                   .Attribute("Material 'conductor' 'float roughness' 0",
                              Objects().Triangles(".2 -.8 .01  4 -.8 .01  4 -.8 3  .2 -.8 3"))
                   .Attribute("Translate .8 -2 2.4", Objects().AreaLight("9 9 9", "'bool twosided' true").Disk(.3)));
}

class SampledLightOnly : public testing::TestWithParam<const char *> {};
INSTANTIATE_TEST_SUITE_P(Integrators, SampledLightOnly, testing::Values("path", "volpath"));

TEST_P(SampledLightOnly, LeavesOutWhatNoChoiceOfLightsChanges) {
    auto render = [&](int depth, bool sampledLightOnly) {
        BuildOptions options;
        options.maxDepth = depth;
        options.sampledLightOnly = sampledLightOnly;
        return RenderText(MirrorScene(GetParam()), options).image;
    };
    // Depth 0 shows emission alone: the light of the lamp that the camera sees.
    const Image lamps = render(0, false), nothing = render(0, true);
    const Image direct = render(1, false), sampled = render(1, true), deep = render(3, false),
                deepSampled = render(3, true);
    double seen = 0, inMirror = 0, caustics = 0;
    ForEachPixel(lamps, [&](Point2i p) {
        const auto at = [&](const Image &image) { return double(image.Get(p, 1)); };
        EXPECT_EQ(at(nothing), 0);
        seen += at(lamps);
        // At depth 1 the random numbers are the same, so the difference is exactly the light that is left out.
        const double left = at(direct) - at(sampled) - at(lamps);
        EXPECT_GE(left, -1e-4 * (1 + at(direct)));
        inMirror += left;
        EXPECT_GE(at(deep) - at(deepSampled), -1e-3 * (1 + at(deep)));
        caustics += at(deep) - at(deepSampled) - at(lamps) - left;
    });
    EXPECT_GT(seen, 1);
    EXPECT_GT(inMirror, 1);
    EXPECT_GT(caustics, 0.01);  // the light that goes from the lamp by the mirror to the floor
}

}  // namespace
}  // namespace pbrt::test
