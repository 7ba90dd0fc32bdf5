// One room at many scales and far from the origin: every integrator renders what it renders at scale 1.
#include <gtest/gtest.h>

#include <map>

#include "placed_scene.h"

namespace pbrt::test {
namespace {

constexpr int kRoomRuns = 6;

/// The walls of a room that is open in front, one of them of triangles, and a ball.
Objects Walls(const Placement &at) {
    return Objects()
        .Diffuse(".7 .7 .7")
        .Quad(at.Points({-1, 0, -1, 1, 0, -1, -1, 0, 1, 1, 0, 1}))
        .Quad(at.Points({-1, 0, -1, 1, 0, -1, -1, 2, -1, 1, 2, -1}))
        .Quad(at.Points({-1, 0, -1, -1, 0, 1, -1, 2, -1, -1, 2, 1}))
        .Triangles(at.Points({1, 0, -1, 1, 0, 1, 1, 2, -1, 1, 2, 1}), "0 1 2 1 3 2")
        .Attribute("Translate" + at.Points({-.3, .4, .2}), Objects().Sphere(.4 * at.scale));
}

std::string RoomView(const Placement &at, const ScaleIntegrator &integrator, const Objects &world) {
    return ViewText(at, integrator, {0, 1, 3.5, 0, .9, 0, 0, 1, 0}, 60, 3, world);
}

/// The room, and lights of one kind.
std::string RoomText(const Placement &at, const ScaleIntegrator &integrator, const Objects &lights) {
    return RoomView(at, integrator, Objects().Add(lights).Add(Walls(at)));
}

/// The room of scale 1 as an instance of one of scale `object`.
std::string EnlargedRoomText(double object, const ScaleIntegrator &integrator, const Objects &lights) {
    return RoomView(
        {}, integrator,
        Objects()
            .Add(lights)
            .Add("ObjectBegin 'room'")
            .Add(Walls({.scale = object}))
            .Add(fmt::format("ObjectEnd\nScale {0:.9g} {0:.9g} {0:.9g}\nObjectInstance 'room'", 1 / object)));
}

Objects Bulb(const Placement &at) { return Objects().PointLight(at.Points({.2, 1.5, .5}), at.Intensity(1)); }
/// Lamps under the ceiling.
Objects TriangleLamp(const Placement &at) {
    const std::string corners = at.Points({-.4, 1.9, -.4, .4, 1.9, -.4, .4, 1.9, .4, -.4, 1.9, .4});
    return Objects().Attribute("", Objects().AreaLight("4 4 4").Triangles(corners));
}
Objects BallLamp(const Placement &at) {
    return Objects().Attribute("Translate" + at.Points({.4, 1.5, .1}),
                               Objects().AreaLight("4 4 4").Sphere(.2 * at.scale));
}
Objects Sky(const Placement &) { return Objects().Sky(".5 .5 .5"); }

using Lights = Objects (*)(const Placement &);
struct Kind {
    const char *name;
    Lights lights;
};
constexpr Kind kKinds[] = {{"bulb", Bulb}, {"triangles", TriangleLamp}, {"ball", BallLamp}, {"sky", Sky}};

/// The room of scale 1, rendered once in this process.
const std::vector<Image> &RoomOfScaleOne(const Kind &kind, const ScaleIntegrator &integrator) {
    static std::map<std::pair<std::string, std::string>, std::vector<Image>> rooms;
    std::vector<Image> &room = rooms[{kind.name, integrator.name}];
    if (room.empty()) room = RenderSeeds(RoomText({}, integrator, kind.lights({})), integrator.Runs(kRoomRuns));
    return room;
}

/// Every integrator at `at` against itself at scale 1.
void ExpectSameRooms(const Placement &at, double allowed) {
    for (const Kind &kind : kKinds) {
        const std::vector<ScaleIntegrator> here = AllIntegrators(at), there = AllIntegrators({});
        for (size_t i = 0; i < here.size(); ++i) {
            const std::vector<Image> ours =
                RenderSeeds(RoomText(at, here[i], kind.lights(at)), here[i].Runs(kRoomRuns));
            const ScaleDifference d = CompareRuns(ours, RoomOfScaleOne(kind, there[i]), allowed);
            std::printf("%s, %s, %s: %s\n", at.Name().c_str(), kind.name, here[i].name.c_str(), d.Text().c_str());
            EXPECT_TRUE(d.Agrees()) << at.Name() << ", " << kind.name << ", " << here[i].name << ": " << d.Text();
        }
    }
}

class RoomsOfScale : public testing::TestWithParam<double> {};
TEST_P(RoomsOfScale, AreAllAlike) { ExpectSameRooms({.scale = GetParam()}, 0.002); }
std::string NameOfScale(const testing::TestParamInfo<double> &scale) {
    const long power = std::lround(std::log10(scale.param));
    return fmt::format("TenTo{}{}", power < 0 ? "Minus" : "", std::abs(power));
}
INSTANTIATE_TEST_SUITE_P(Scales, RoomsOfScale, testing::Values(1e-8, 1e-4, 1e4, 1e7, 1e8), NameOfScale);

/// In world coordinates the rooms are 3200 and 32 000 of their steps wide there.
TEST(RoomsFarAway, AreAlike) {
    const auto expectAlike = [](double scale, const char *system) {
        ExpectSameRooms({.scale = scale, .offset = {1e6, -1e6, 1e6}, .renderCoordSys = system}, 0.01);
    };
    expectAlike(100, "cameraworld");
    expectAlike(1000, "camera");
    expectAlike(100, "world");
    expectAlike(1000, "world");
}

TEST(RoomsAsInstances, OfTinyObjectsAreAlike) {
    for (const Kind &kind : kKinds)
        for (const ScaleIntegrator &integrator : AllIntegrators({})) {
            const std::vector<Image> ours =
                RenderSeeds(EnlargedRoomText(1e-8, integrator, kind.lights({})), integrator.Runs(kRoomRuns));
            const ScaleDifference d = CompareRuns(ours, RoomOfScaleOne(kind, integrator), 0.002);
            EXPECT_TRUE(d.Agrees()) << kind.name << ", " << integrator.name << ": " << d.Text();
        }
}

}  // namespace
}  // namespace pbrt::test
