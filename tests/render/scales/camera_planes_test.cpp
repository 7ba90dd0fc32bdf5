// Lamps and walls in the plane of the camera are edge-on: not seen, although rounding may move them in front of it.
#include <gtest/gtest.h>

#include <map>

#include "placed_scene.h"

namespace pbrt::test {
namespace {

/// A lamp in the plane z = 5 + behind, seen from z = 5.
std::string FlashText(const Objects &lamp, double behind, const ScaleIntegrator &integrator) {
    return ViewText({}, integrator, {0, 0, 5, 0, 0, 0, 0, 1, 0}, 40, 3,
                    Objects()
                        .Attribute(fmt::format("Translate 0 0 {} Rotate 180 0 1 0", 5 + behind),
                                   Objects().AreaLight("5 5 5").Add(lamp))
                        .Diffuse(".7 .6 .5")
                        .Sphere(1)
                        .Quad("-6 -6 -2  6 -6 -2  -6 6 -2  6 6 -2"));
}

TEST(CameraInThePlaneOfALamp, DoesNotSeeIt) {
    const std::string square = " -.5 -.5 0  .5 -.5 0  -.5 .5 0  .5 .5 0";
    for (const ScaleIntegrator &integrator : AllIntegrators({}))
        for (const Objects &lamp : {Objects().Triangles(square, kTwoTriangles), Objects().Quad(square)})
            ExpectSame(integrator.name + ", " + std::string(lamp).substr(7, 14),
                       RenderSeeds(FlashText(lamp, 0, integrator), integrator.Runs(kScaleRuns)),
                       RenderSeeds(FlashText(lamp, 1e-4, integrator), integrator.Runs(kScaleRuns)), 0.002);
}

/// A camera that looks at a ball; its lens, and what the transformations of scene and camera say where it is.
struct View {
    std::string type, parameters{};
};
const View kViews[] = {{"perspective", "'float fov' 40"},
                       {"perspective", "'float fov' 40 'float lensradius' .05 'float focaldistance' 5"},
                       {"orthographic", "'float screenwindow' [ -2 2 -2 2 ]"}};
struct Oblique {
    std::string name, lookAt;
    std::string ofScene{}, ofCamera{};  ///< a transformation and its inverse
    std::string atCamera = "CoordSysTransform 'camera'";
};
/// Where the same rounded transformation places camera and lamp, and where several place them.
std::vector<Oblique> ObliqueCameras() {
    std::vector<Oblique> cameras{{"oblique", "3 2 5  0 0 0  0 1 0"},
                                 {"nearly along z", "-1 .7 4  0 0 0  0 1 0"},
                                 {"far away", "30 20 50  0 0 0  0 1 0"},
                                 {"at the origin", "0 0 0  -3 -2 -5  0 1 0"}};
    const std::string flipped = "Translate 0 0 5 Rotate 180 0 1 0";
    for (const std::string turn : {"37 .3 .5 .8", "77 .9 .2 .1", "11 -.4 .3 .8"})
        cameras.push_back({"turned by " + turn, "0 0 5  0 0 0  0 1 0", "Rotate " + turn, "Rotate -" + turn, flipped});
    cameras.push_back({"turned and moved", "0 0 5  0 0 0  0 1 0", "Translate 1.1 3.3 -2.7 Rotate 77 .9 .2 .1",
                       "Rotate -77 .9 .2 .1 Translate -1.1 -3.3 2.7", flipped});
    return cameras;
}
struct Lamp {
    const char *name;
    Objects (*objects)(double z);
};
std::string SquareAt(double z) { return fmt::format("-.5 -.5 {0}  .5 -.5 {0}  -.5 .5 {0}  .5 .5 {0}", z); }
const Lamp kLamps[] = {
    {"triangles", [](double z) { return Objects().Triangles(SquareAt(z), kTwoTriangles); }},
    {"patch", [](double z) { return Objects().Quad(SquareAt(z)); }},
    {"trapezoid",
     [](double z) { return Objects().Quad(fmt::format("-.5 -.5 {0}  .55 -.5 {0}  -.5 .5 {0}  .5 .6 {0}", z)); }},
    {"disk", [](double z) { return Objects().Shape("disk", fmt::format("'float radius' .5 'float height' {}", z)); }},
};

std::string ObliqueText(const Oblique &o, const View &view, const ScaleIntegrator &integrator, const Objects &world) {
    return SceneText()
        .LookAt(o.lookAt)
        .Head(o.ofCamera)
        .Camera(view.type, view.parameters)
        .Filter("box")
        .Film(kScaleResolution, kScaleResolution, "'bool savefp16' false")
        .Samples(integrator.samples)
        .Integrator(integrator.name, 3, integrator.parameters)
        .World(Objects().Add(o.ofScene).Add(world));
}
/// A lamp `behind` the plane of the camera.
std::string ObliqueFlashText(const Oblique &o, const View &view, const ScaleIntegrator &integrator, const Lamp &lamp,
                             double behind) {
    return ObliqueText(o, view, integrator,
                       Objects()
                           .Attribute(o.atCamera, Objects().AreaLight("5 5 5").Add(lamp.objects(-behind)))
                           .Diffuse(".7 .6 .5")
                           .Sphere(1)
                           .Quad("-6 -6 -2  6 -6 -2  -6 6 -2  6 6 -2"));
}

TEST(CameraInThePlaneOfALamp, DoesNotSeeItObliquely) {
    auto expectUnseen = [](const Oblique &o, const View &view, const ScaleIntegrator &integrator, const Lamp &lamp) {
        const int runs = integrator.Runs(kScaleRuns);
        ExpectSame(fmt::format("{}, {} {}, {}, {}", o.name, view.type, view.parameters, integrator.name, lamp.name),
                   RenderSeeds(ObliqueFlashText(o, view, integrator, lamp, 0), runs),
                   RenderSeeds(ObliqueFlashText(o, view, integrator, lamp, 1e-4), runs), 0.002);
    };
    const std::vector<Oblique> cameras = ObliqueCameras();
    for (const Oblique &o : cameras)
        for (const Lamp &lamp : kLamps)
            for (const char *integrator : {"path", "bdpt"}) expectUnseen(o, kViews[0], {integrator}, lamp);
    for (const View &view : kViews)
        for (const Lamp &lamp : kLamps) expectUnseen(cameras[0], view, {"path"}, lamp);
    for (const ScaleIntegrator &integrator : AllIntegrators({}))
        expectUnseen(cameras[0], kViews[0], integrator, kLamps[1]);
}

/// Black planes through the camera do not hide the sky.
TEST(CameraInThePlaneOfAWall, DoesNotSeeIt) {
    std::vector<Oblique> cameras = ObliqueCameras();
    cameras.push_back({"very far away", "300 200 500  0 0 0  0 1 0"});
    for (const Oblique &o : cameras) {
        const auto mean = [&](const char *integrator, const Objects &wall) {
            const Objects world = Objects().Sky("1 1 1").Add(wall);
            return MeanOf(RenderSeeds(ObliqueText(o, kViews[0], {integrator}, world), 1)[0]);
        };
        const std::map<std::string, double> sky{{"path", mean("path", {})}, {"bdpt", mean("bdpt", {})}};
        for (const Lamp &wall : kLamps)
            for (const bool instanced : {false, true}) {
                const Objects black = Objects().Diffuse("0 0 0").Add(wall.objects(0));
                const Objects world = instanced ? Objects()
                                                      .Add("ObjectBegin 'o'")
                                                      .Add(black)
                                                      .Add("ObjectEnd")
                                                      .Attribute(o.atCamera, Objects().Add("ObjectInstance 'o'"))
                                                : Objects().Attribute(o.atCamera, black);
                for (const auto &[integrator, expected] : sky)
                    EXPECT_NEAR(mean(integrator.c_str(), world), expected, 1e-6)
                        << o.name << ", " << wall.name << (instanced ? ", instance, " : ", ") << integrator;
            }
    }
}

}  // namespace
}  // namespace pbrt::test
