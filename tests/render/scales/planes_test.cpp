// Point lights that lie exactly in the plane of a wall light both of its sides, as if it were not there.
#include <gtest/gtest.h>

#include "placed_scene.h"

namespace pbrt::test {
namespace {

/// A view of the floor on one side (-1, 1) of a wall at x = 0.
std::string BesideWallText(const Placement &at, const ScaleIntegrator &integrator, double side, bool hasWall) {
    Objects world;
    world.PointLight(at.Points({0, .25, .125}), at.Intensity(10)).Diffuse(".5 .5 .5");
    if (hasWall) world.Quad(at.Points({0, -1, -2, 0, -1, 2, 0, 2, -2, 0, 2, 2}));
    world.Quad(at.Points({-4, -1, -4, 4, -1, -4, -4, -1, 4, 4, -1, 4}));
    return ViewText(at, integrator, {3 * side, 3, 0, 2 * side, -1, 0, 0, 1, 0}, 30, 1, world);
}

TEST(PointLights, InThePlaneOfAWallLightBothSides) {
    for (const Placement &at : {Placement{}, {.scale = 1e-6}, {.scale = 1e6}, {.scale = 1e3, .offset = {1e6, 0, 1e6}}})
        for (const ScaleIntegrator &integrator : AllIntegrators(at))
            for (const double side : {-1., 1.}) {
                const int runs = integrator.Runs(4);
                const std::vector<Image> without = RenderSeeds(BesideWallText(at, integrator, side, false), runs);
                const ScaleDifference d =
                    CompareRuns(RenderSeeds(BesideWallText(at, integrator, side, true), runs), without, 0.002);
                EXPECT_GT(MeanOf(without[0]), 0.01) << integrator.name;
                EXPECT_TRUE(d.Agrees()) << at.Name() << ", side " << side << ", " << integrator.name << ": "
                                        << d.Text();
            }
}

}  // namespace
}  // namespace pbrt::test
