// The light that integrators add to the film is the same at any scale, and maxcomponentvalue only cuts what is above
// it.
#include <gtest/gtest.h>

#include "support/render_scene.h"
#include "support/scene_text.h"

namespace pbrt::test {
namespace {

const char *const kFewMutations = "'integer mutationsperpixel' 16 'integer bootstrapsamples' 2000";

/// A wall lit by a sphere of this radiance, both seen by the camera.
Image Wall(const std::string &integrator, double radiance, const std::string &film = "") {
    return RenderText(SceneText()
                          .Film(32, 24, film)
                          .Samples(16)
                          .Integrator(integrator, 3, integrator == "mlt" ? kFewMutations : "")
                          .LookAt(".3 .2 6  0 0 0  0 1 0")
                          .Camera(40)
                          .World(Objects()
                                     .Attribute("Translate 1.2 .3 .6",
                                                Objects().AreaLight(fmt::format("{0} {0} {0}", radiance)).Sphere(.3))
                                     .Diffuse(".7 .5 .3")
                                     .Quad("-6 -6 0  6 -6 0  -6 6 0  6 6 0")))
        .image;
}

class EveryIntegrator : public testing::TestWithParam<const char *> {};
INSTANTIATE_TEST_SUITE_P(Splats, EveryIntegrator,
                         testing::Values("path", "volpath", "bdpt", "lightpath", "mlt", "sppm"),
                         [](const auto &test) { return test.param; });

TEST_P(EveryIntegrator, KeepsTheScaleOfLight) {
    // Powers of two, 7.9e-31 and 6.3e29, so that nothing is rounded otherwise than at the scale 1 but for two things at
    // 7.9e-31: floats below 1.2e-38 are multiples of 1.4e-45, and splats are added as multiples of 2^-144, which is
    // 5.7e-14 of the radiance. Either may change the float nearest to a pixel's sum, and so its colour by some ulps.
    const Image unit = Wall(GetParam(), 1);
    EXPECT_GT(ChannelStatistics(unit).mean, 0.01);
    for (const int exponent : {-100, 99}) {
        const Image scaled = Wall(GetParam(), std::ldexp(1, exponent));
        ForEachValue(unit, [&](Point2i p, int c) {
            const Float largest = std::max({unit.Get(p, 0), unit.Get(p, 1), unit.Get(p, 2)});
            ASSERT_NEAR(std::ldexp(double(scaled.Get(p, c)), -exponent), double(unit.Get(p, c)),
                        1e-6 * double(largest) + 1e-10)
                << exponent << ": " << p.x << ", " << p.y;
        });
    }
}

TEST_P(EveryIntegrator, MaxComponentValueCutsOnlyWhatIsAboveIt) {
    const Image uncut = Wall(GetParam(), 1);
    EXPECT_TRUE(SameBits(Wall(GetParam(), 1, "'float maxcomponentvalue' 5"), uncut));
    EXPECT_LT(ChannelStatistics(Wall(GetParam(), 1, "'float maxcomponentvalue' .01")).mean,
              0.8 * ChannelStatistics(uncut).mean);
}

}  // namespace
}  // namespace pbrt::test
