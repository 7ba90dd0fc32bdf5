// Floors of every size under a ball, and instances far from the origin: every integrator renders what it renders for a
// small floor, a copy.
#include <gtest/gtest.h>

#include "placed_scene.h"

namespace pbrt::test {
namespace {

/// A floor of the half width r at y = -1; `x`: of its last corner.
std::string FloorCorners(double r, double x = 1) {
    return Placement{r}.Points({-1, -1 / r, -1, 1, -1 / r, -1, -1, -1 / r, 1, x, -1 / r, 1});
}
/// The same as an instance of a floor of half width 1. `height`: scale along y.
Objects InstancedFloor(double r, double height, bool isTriangles) {
    const std::string unit = "-1 0 -1 1 0 -1 -1 0 1 1 0 1";
    return Objects()
        .Add("ObjectBegin 'floor' Identity")
        .Add(isTriangles ? Objects().Triangles(unit, kTwoTriangles) : Objects().Quad(unit))
        .Add("ObjectEnd")
        .Attribute(fmt::format("Translate 0 -1 0 Scale {0:.9g} {1:.9g} {0:.9g}", r, height),
                   Objects().Add("ObjectInstance 'floor'"));
}
/// A floor of 6 x 6 squares of two triangles.
Objects GridFloor(double r) {
    constexpr int kSquares = 6;
    std::string indices, points;
    for (int i = 0; i < (kSquares + 1) * (kSquares + 1); ++i) {
        const int x = i % (kSquares + 1), z = i / (kSquares + 1), right = i + 1, below = i + kSquares + 1;
        points += fmt::format(" {:.9g} -1 {:.9g}", r * (2. * x / kSquares - 1), r * (2. * z / kSquares - 1));
        if (x < kSquares && z < kSquares)
            indices += fmt::format(" {0} {1} {2} {1} {3} {2}", i, right, below, below + 1);
    }
    return Objects().Triangles(points, indices);
}
struct Floor {
    const char *name;
    Objects (*objects)(double r);
};
const Floor kFloors[] = {
    {"triangles", [](double r) { return Objects().Triangles(FloorCorners(r), kTwoTriangles); }},
    {"patch", [](double r) { return Objects().Quad(FloorCorners(r)); }},
    {"grid", GridFloor},
    {"trapezoid", [](double r) { return Objects().Quad(FloorCorners(r, 1.5)); }},
    {"disk", [](double r) { return Objects().Attribute("Translate 0 -1 0 Rotate -90 1 0 0", Objects().Disk(r)); }},
    {"instance", [](double r) { return InstancedFloor(r, r, true); }},
    {"instance stretched along two axes", [](double r) { return InstancedFloor(r, 1, true); }},
    {"instanced patch stretched along two axes", [](double r) { return InstancedFloor(r, 1, false); }},
};

std::string FloorText(const Floor &floor, double r, const ScaleIntegrator &integrator) {
    return ViewText({}, integrator, {0, 4, 5, 0, -.5, 0, 0, 1, 0}, 40, 3,
                    Objects().PointLight("-2 3 3", "9 9 9").Diffuse(".5 .5 .5").Sphere(.8).Add(floor.objects(r)));
}

TEST(Floors, AreAllAlike) {
    for (const Floor &floor : kFloors) {
        const std::vector<Image> small = RenderSeeds(FloorText(floor, 1e3, {"path"}), kScaleRuns);
        EXPECT_GT(MeanOf(small[0]), 0.01);
        for (const double r : {1e5, 1e6, 1e7, 1e8})
            ExpectSame(fmt::format("{} of {:g}", floor.name, r), RenderSeeds(FloorText(floor, r, {"path"}), kScaleRuns),
                       small, 0.0005);
    }
}

TEST(Floors, AreAlikeInEveryIntegrator) {
    for (const ScaleIntegrator &integrator : AllIntegrators({})) {
        const int runs = integrator.Runs(kScaleRuns);
        const std::vector<Image> small = RenderSeeds(FloorText(kFloors[0], 1e3, integrator), runs);
        for (const double r : {1e6, 1e8})
            ExpectSame(fmt::format("{} with a floor of {:g}", integrator.name, r),
                       RenderSeeds(FloorText(kFloors[0], r, integrator), runs), small, 0.001);
    }
}

/// The scene and its camera are turned: the floor's corners are rounded along its normal.
std::string TiltedFloorText(const Floor &floor, double r, const ScaleIntegrator &integrator) {
    const std::string turn = "25 .3 .5 .8";
    return SceneText()
        .LookAt("0 1 5  0 0 0  0 1 0")
        .Head("Rotate -" + turn)
        .Camera(40)
        .Filter("box")
        .Film(kScaleResolution, kScaleResolution, "'bool savefp16' false")
        .Samples(integrator.samples)
        .Integrator(integrator.name, 3)
        .World(Objects()
                   .Add("Rotate " + turn)
                   .PointLight("-2 3 3", "9 9 9")
                   .Diffuse(".5 .5 .5")
                   .Sphere(.8)
                   .Attribute("Translate 1.2 -.9 .6", Objects().Sphere(.1))
                   .Add(floor.objects(r)));
}

TEST(Floors, MayBeTilted) {
    constexpr int kRuns = 8;
    for (const char *integrator : {"path", "bdpt"})
        for (const Floor &floor : kFloors) {
            const std::vector<Image> small = RenderSeeds(TiltedFloorText(floor, 1e3, {integrator}), kRuns);
            for (const double r : {1e6, 1e8})
                ExpectSame(fmt::format("{} of {:g}, tilted, {}", floor.name, r, integrator),
                           RenderSeeds(TiltedFloorText(floor, r, {integrator}), kRuns), small, 0.001);
        }
}

/// The ground is a sphere of the size of the Earth.
TEST(Floors, MayBeAPlanet) {
    const std::vector<Image> flat = RenderSeeds(FloorText(kFloors[0], 1e3, {"path"}), kScaleRuns);
    const Floor planet{"planet", [](double r) {
                           return Objects().Attribute(
                               fmt::format("Translate 0 {:.9g} 0", -r - 1),
                               Objects().Shape("sphere", fmt::format("'float radius' {:.9g}", r)));
                       }};
    ExpectSame("planet", RenderSeeds(FloorText(planet, 6371000, {"path"}), kScaleRuns), flat, 0.0005);
}

/// A floor under a lamp that nearly fills its sky.
std::string LargeLampText(const Objects &lamp, const ScaleIntegrator &integrator) {
    return ViewText({}, integrator, {0, 1, 2, 0, 0, 0, 0, 1, 0}, 30, 1,
                    Objects()
                        .Attribute("Translate 0 2 0 Rotate 90 1 0 0", Objects().AreaLight("1 1 1").Add(lamp))
                        .Diffuse(".5 .5 .5")
                        .Quad("-5 0 -5 5 0 -5 -5 0 5 5 0 5"));
}

/// The diagonal is overhead: as seen from the floor its ends are nearly antipodal.
TEST(LargeLamps, OfTwoTrianglesAreAlike) {
    for (const ScaleIntegrator &integrator : {ScaleIntegrator{"path"}, ScaleIntegrator{"bdpt"},
                                              ScaleIntegrator{"simplepath", "'bool samplelights' true"}}) {
        const std::string small = Placement{1e3}.Points({-1, -1, 0, 1, -1, 0, -1, 1, 0, 1, 1, 0});
        const std::vector<Image> patch = RenderSeeds(LargeLampText(Objects().Quad(small), integrator), kScaleRuns);
        EXPECT_NEAR(MeanOf(patch[0]), 0.5, 0.02);
        for (const double r : {1e3, 1e5, 1e6})
            for (const char *order : {"0 1 2 1 3 2", "1 2 0 3 2 1", "0 1 2 3 2 1"}) {
                const std::string corners = Placement{r}.Points({-1, -1, 0, 1, -1, 0, -1, 1, 0, 1, 1, 0});
                ExpectSame(fmt::format("{}, two triangles {} of {:g}", integrator.name, order, r),
                           RenderSeeds(LargeLampText(Objects().Triangles(corners, order), integrator), kScaleRuns),
                           patch, 0.005);
            }
    }
}

/// A room with two lamps under a sun of real size, in metres.
std::string SunText(const std::string &sun, const ScaleIntegrator &integrator) {
    return ViewText({}, integrator, {0, 1, 5, 0, 0, 0, 0, 1, 0}, 40, 3,
                    Objects()
                        .Add(sun)
                        .Attribute("Translate 1 .5 1", Objects().AreaLight("900 100 100").Sphere(.05))
                        .PointLight("-1 1 1", "5 9 30")
                        .Diffuse(".7 .7 .7")
                        .Quad("-3 -1 -3  3 -1 -3  -3 -1 3  3 -1 3")
                        .Quad("-3 -1 -3  3 -1 -3  -3 3 -3  3 3 -3")
                        .Sphere(.5));
}

TEST(Suns, LeaveSamplesToLamps) {
    const std::string disk =
        Objects().Attribute("Translate 4.53e10 1.209e11 7.556e10", Objects().AreaLight("2e4 2e4 2e4").Sphere(6.96e8));
    const std::string point =
        "LightSource 'point' 'point3 from' [4.53e10 1.209e11 7.556e10] 'rgb I' [1e22 1e22 1e22]\n";
    for (const std::string &sun : {disk, point}) {
        const std::vector<Image> all =
            RenderSeeds(SunText(sun, {"path", "'string lightsampler' 'uniform'", 64}), kScaleRuns);
        for (const ScaleIntegrator &integrator :
             {ScaleIntegrator{"path", "'string lightsampler' 'power'", 64}, ScaleIntegrator{"bdpt", "", 64}})
            ExpectSame(integrator.name + " under " + sun.substr(0, 24),
                       RenderSeeds(SunText(sun, integrator), kScaleRuns), all, 0.02);
    }
}

/// A subdivided tetrahedron, given `size` times as large as it is placed: its normals are as long as size^2.
std::string SubdivisionText(double size) {
    const std::string corners = Placement{size}.Points({.9, .9, .9, -.9, -.9, .9, -.9, .9, -.9, .9, -.9, -.9});
    return ViewText({}, {"path"}, {0, 1, 5, 0, 0, 0, 0, 1, 0}, 40, 3,
                    Objects()
                        .PointLight("-2 3 3", "9 9 9")
                        .Diffuse(".5 .5 .5")
                        .Attribute(fmt::format("Rotate 33 .2 .9 .4 Scale {0:.9g} {0:.9g} {0:.9g}", 1 / size),
                                   Objects().Shape("loopsubdiv", "'integer levels' 3 'point3 P' [" + corners +
                                                                     "] 'integer indices' [0 2 1 0 1 3 0 3 2 1 2 3]"))
                        .Quad("-5 -1 -5 5 -1 -5 -5 -1 5 5 -1 5"));
}

TEST(Subdivision, IsAlikeFromEverySize) {
    const std::vector<Image> one = RenderSeeds(SubdivisionText(1), kScaleRuns);
    EXPECT_GT(MeanOf(one[0]), 0.01);
    for (const double size : {1e-12, 1e-8, 1e-4, 1e4, 1e7, 1e8, 1e12})
        ExpectSame(fmt::format("subdivision from {:g}", size), RenderSeeds(SubdivisionText(size), kScaleRuns), one,
                   0.0005);
}

/// A ball on a floor: as it is, or as an instance. `size`: of both in the units of their object.
struct Object {
    std::array<double, 3> at{0, 0, 0};  ///< where the view is
    double size = 1;
    std::string renderCoordSys{};
};
std::string ObjectView(const Object &o, const std::string &object) {
    const Placement place{.offset = o.at, .renderCoordSys = o.renderCoordSys};
    return ViewText(place, {"path"}, {0, 4, 5, 0, -.5, 0, 0, 1, 0}, 40, 3,
                    Objects().PointLight(place.Points({-2, 3, 3}), "9 9 9").Diffuse(".5 .5 .5").Add(object));
}
/// Around `origin`, in units of `size`.
std::string BallAndFloor(double size, const std::array<double, 3> &origin = {0, 0, 0}) {
    const Placement place{size, origin};
    return Objects()
        .Attribute("Translate" + place.Points({0, 0, 0}), Objects().Sphere(.8 * size))
        .Triangles(place.Points({-4, -1, -4, 4, -1, -4, -4, -1, 4, 4, -1, 4}), kTwoTriangles);
}

TEST(Instances, AreAsExactAsCopies) {
    const Object objects[] = {
        {{131072, 0, -131072}}, {{1048576, 0, -1048576}},   {{1048576, 0, -1048576}, 1, "camera"}, {{0, 0, 0}, 1e-4},
        {{0, 0, 0}, 1e-6},      {{0, 0, 0}, 1e-6, "world"}, {{65536, 0, 65536}, 1e-4, "camera"}};
    for (const Object &o : objects) {
        const std::string move = "Translate" + Placement{.offset = o.at}.Points({0, 0, 0}),
                          enlarge = fmt::format(" Scale {0:.9g} {0:.9g} {0:.9g} ", 1 / o.size);
        auto define = [](const std::string &shapes) { return "ObjectBegin \"o\" " + shapes + "ObjectEnd\n"; };
        const std::string place = "ObjectInstance \"o\"\n";
        auto in = [](const std::string &text) { return "AttributeBegin " + text + "AttributeEnd\n"; };
        auto render = [&](const std::string &object) { return RenderSeeds(ObjectView(o, object), kScaleRuns); };
        const std::string shapes = BallAndFloor(o.size);
        const std::vector<Image> copy = render(in(move + enlarge + shapes));
        const std::string name =
            fmt::format("{:g} {:g} {:g}, size {:g} {}", o.at[0], o.at[1], o.at[2], o.size, o.renderCoordSys);
        ExpectSame("instance at " + name, render(define(shapes) + in(move + enlarge + place)), copy, 0.0005);
        ExpectSame("defined and used at " + name, render(in(move + enlarge + define(shapes)) + place), copy, 0.0005);
        if (o.size != 1) continue;
        ExpectSame("vertices at " + name, render(define(BallAndFloor(1, o.at)) + place), copy, 0.0005);
    }
}

}  // namespace
}  // namespace pbrt::test
