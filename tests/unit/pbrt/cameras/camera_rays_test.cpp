#include "camera_cases.h"
#include "pbrt/math/rng.h"
#include "pbrt/math/warps.h"

namespace pbrt::test {
namespace {

TEST(PerspectiveCamera, FovSpansTheShorterAxis) {
    Float edge = std::tan(Radians(20));
    auto wide = MakeTestCamera("perspective", Params().Number("fov", 40), {40, 20});
    ExpectClose(AtDepth(RayAt(*wide, {20, 10}).ray, 1), {0, 0, 1}, 1e-6f, "centre");
    ExpectClose(AtDepth(RayAt(*wide, {20, 0}).ray, 1), {0, edge, 1}, 1e-6f, "top");
    ExpectClose(AtDepth(RayAt(*wide, {0, 20}).ray, 1), {-2 * edge, -edge, 1}, 1e-6f, "bottom left");
    ExpectClose(AtDepth(RayAt(*wide, {40, 10}).ray, 1), {2 * edge, 0, 1}, 1e-6f, "right");
    auto tall = MakeTestCamera("perspective", Params().Number("fov", 40), {20, 50});
    ExpectClose(AtDepth(RayAt(*tall, {20, 25}).ray, 1), {edge, 0, 1}, 1e-6f, "right");
    ExpectClose(AtDepth(RayAt(*tall, {10, 0}).ray, 1), {0, 2.5f * edge, 1}, 1e-6f, "top");
    auto square = MakeTestCamera("perspective", Params(), {10, 10});  // fov 90
    ExpectClose(AtDepth(RayAt(*square, {10, 0}).ray, 1), {1, 1, 1}, 1e-6f, "corner");
}

TEST(PerspectiveCamera, FrameAspectRatioAndScreenWindowSetTheWindow) {
    auto aspect = MakeTestCamera("perspective", Params().Number("frameaspectratio", 1.25f), {64, 80});
    ExpectClose(AtDepth(RayAt(*aspect, {64, 0}).ray, 1), {1.25f, 1, 1}, 1e-6f);
    auto narrow = MakeTestCamera("perspective", Params().Number("frameaspectratio", 0.5f), {64, 80});
    ExpectClose(AtDepth(RayAt(*narrow, {64, 0}).ray, 1), {1, 2, 1}, 1e-6f);
    auto window = MakeTestCamera(
        "perspective",
        Params().Floats(ParamType::Float, "screenwindow", {-1.1f, 0.7f, -0.5f, 0.6f}).Number("frameaspectratio", 1.2f));
    ExpectClose(AtDepth(RayAt(*window, {0, 0}).ray, 1), {-1.1f, 0.6f, 1}, 1e-6f, "top left");
    ExpectClose(AtDepth(RayAt(*window, {40, 20}).ray, 1), {0.7f, -0.5f, 1}, 1e-6f, "bottom right");
}

TEST(PerspectiveCamera, LensFocusesAtFocalDistanceOnly) {
    auto pinhole = MakeTestCamera("perspective");
    auto camera = MakeTestCamera("perspective", Params().Number("lensradius", 0.3f).Number("focaldistance", 5));
    Rng rng(1);
    Float spread = 0, farthest = 0;
    ExpectClose(AtDepth(RayAt(*camera, {7, 8}, {0.5f, 0.5f}).ray, 3), AtDepth(RayAt(*pinhole, {7, 8}).ray, 3), 1e-5f);
    for (int i = 0; i < 500; ++i) {
        CameraRay r = RayAt(*camera, {33, 2}, rng.Uniform2());
        ExpectClose(AtDepth(r.ray, 5), AtDepth(RayAt(*pinhole, {33, 2}).ray, 5), 1e-5f, "focus");
        EXPECT_EQ(r.ray.o.z, 0);
        farthest = std::max(farthest, Length(r.ray.o));
        spread = std::max(spread, Distance(AtDepth(r.ray, 10), AtDepth(RayAt(*pinhole, {33, 2}).ray, 10)));
    }
    EXPECT_LE(farthest, 0.3f + 1e-6f);
    EXPECT_GT(farthest, 0.28f);
    EXPECT_NEAR(spread, 0.3f, 0.02f);  // at twice the focal distance the blur is as wide as the lens
}

TEST(EveryCamera, DifferentialsAreTheRaysOfTheNextPixels) {
    Transform t = Transform::Translate({1, 2, 3}) * Transform::Rotate(50, {1, 1, 0}) * Transform::Scale({-2, 2, 2});
    Rng rng(2);
    for (const auto &[name, camera] : AllCameras(t, 400)) {
        const bool spherical = name.starts_with("equ");
        for (int i = 0; i < 100; ++i) {
            Point2 film = rng.Uniform2() * Point2(36, 16) + Point2(1, 1), lens = rng.Uniform2();
            if (spherical) film = film * 10.f;
            // The equal-area map has creases; stay inside one of its eight facets.
            if (name == "equal-area") film = Point2(220, 220) + rng.Uniform2() * Point2(40, 70);
            CameraRay r = RayAt(*camera, film, lens);
            ASSERT_TRUE(r.differential.valid);
            CameraRay x = RayAt(*camera, film + Point2(1, 0), lens), y = RayAt(*camera, film + Point2(0, 1), lens);
            // The rays of a spherical camera do not lie on a plane, and its differentials are extrapolated; they may
            // differ by part of a step.
            Float tolerance = spherical ? 0.3f * Distance(x.ray.d, r.ray.d) + 2e-3f : 2e-5f;
            ExpectClose(r.differential.rxOrigin, x.ray.o, 1e-5f, "x origin");
            ExpectClose(r.differential.ryOrigin, y.ray.o, 1e-5f, "y origin");
            ExpectClose(r.differential.rxDirection, x.ray.d, tolerance, "x direction");
            ExpectClose(r.differential.ryDirection, y.ray.d, tolerance, "y direction");
        }
    }
}

TEST(EveryCamera, RaysAreUnitWeightedByOneAndTimedByTheShutter) {
    Transform t = Transform::Scale({3, 3, 3});
    for (const auto &[name, camera] : AllCameras(t, 400)) {
        CameraRay r = RayAt(*camera, {3.3f, 4.4f}, {0.2f, 0.9f}, 0.25f);
        EXPECT_NEAR(Length(r.ray.d), 1, 1e-6f);
        EXPECT_EQ(r.ray.time, 0.25f);
        EXPECT_EQ(r.ray.tMax, Infinity);
        for (int i = 0; i < SpectrumSamples; ++i) EXPECT_EQ(r.weight[i], 1) << name;
    }
    auto camera = MakeTestCamera("perspective", Params().Number("shutteropen", 2).Number("shutterclose", 6));
    EXPECT_EQ(RayAt(*camera, {1, 1}, {0, 0}, 0).ray.time, 2);
    EXPECT_EQ(RayAt(*camera, {1, 1}, {0, 0}, 0.75f).ray.time, 5);
    EXPECT_EQ(camera->ShutterOpen(), 2);
    EXPECT_EQ(camera->ShutterClose(), 6);
}

TEST(EveryCamera, RaysGoToRenderingSpace) {
    Transform t = Transform::Translate({10, 20, 30}) * Transform::Rotate(70, {1, 2, 3}) * Transform::Scale({-1, 1, 1});
    const auto plain = AllCameras({}, 400), moved = AllCameras(t, 400);
    for (size_t i = 0; i < plain.size(); ++i) {
        CameraRay a = RayAt(*plain[i].camera, {3.3f, 14.4f}, {0.2f, 0.9f}),
                  b = RayAt(*moved[i].camera, {3.3f, 14.4f}, {0.2f, 0.9f});
        ExpectClose(b.ray.o, t.Point(a.ray.o), 1e-5f);
        ExpectClose(b.ray.d, t.Vector(a.ray.d), 1e-5f);
        ExpectClose(moved[i].camera->CameraFromRender(0).Point(b.ray.o), a.ray.o, 1e-5f);
    }
}

TEST(OrthographicCamera, RaysAreParallelAndScreenIsInWorldUnits) {
    auto camera = MakeTestCamera("orthographic", Params().Floats(ParamType::Float, "screenwindow", {-3, 5, -2, 1}));
    CameraRay a = RayAt(*camera, {0, 0}), b = RayAt(*camera, {40, 20});
    ExpectClose(a.ray.o, {-3, 1, 0}, 1e-6f);
    ExpectClose(b.ray.o, {5, -2, 0}, 1e-6f);
    EXPECT_EQ(a.ray.d, Vector3(0, 0, 1));
    EXPECT_EQ(b.ray.d, Vector3(0, 0, 1));
}

TEST(SphericalCamera, DirectionsOfTheMappings) {
    auto lat = MakeTestCamera("spherical", Params().String("mapping", "equirectangular"), {40, 20});
    ExpectClose(RayAt(*lat, {0, 10}).ray.d, {1, 0, 0}, 1e-6f, "left edge");
    ExpectClose(RayAt(*lat, {10, 10}).ray.d, {0, 0, 1}, 1e-6f, "quarter");
    ExpectClose(RayAt(*lat, {13, 0}).ray.d, {0, 1, 0}, 1e-6f, "top");
    ExpectClose(RayAt(*lat, {13, 20}).ray.d, {0, -1, 0}, 1e-6f, "bottom");
    auto area = MakeTestCamera("spherical", Params(), {20, 20});
    ExpectClose(RayAt(*area, {10, 10}).ray.d, {0, 1, 0}, 1e-6f, "centre");
    ExpectClose(RayAt(*area, {20, 10}).ray.d, {1, 0, 0}, 1e-6f, "right");
    ExpectClose(RayAt(*area, {10, 20}).ray.d, {0, 0, 1}, 1e-6f, "below");
    ExpectClose(RayAt(*area, {0, 0}).ray.d, {0, -1, 0}, 1e-6f, "corner");
}

TEST(NdcFromCamera, MatchesTheHeadersOfStockPbrt) {
    // The expected numbers are worldToNDC * inverse(worldToCamera) of
    // conformance/reference/cameras/perspective_screenwindow.exr, whose fov is 50.
    auto camera = MakeTestCamera("perspective", Params().Number("fov", 50));
    Transform ndc = camera->NdcFromCamera().value();
    const glm::mat4 &m = ndc.Matrix();
    EXPECT_NEAR(m[0][0], 1.0722535f, 1e-5f);
    EXPECT_NEAR(m[1][1], 1.0722535f, 1e-5f);
    EXPECT_NEAR(m[2][0], 0.5f, 1e-6f);
    EXPECT_NEAR(m[2][2], 1.000005f, 1e-6f);
    EXPECT_NEAR(m[3][2], -0.005f, 1e-6f);
    EXPECT_EQ(m[2][3], 1);
    // The transform of the orthographic camera halves and shifts.
    Transform o = MakeTestCamera("orthographic")->NdcFromCamera().value();
    ExpectClose(o.Point({1, -1, 6.541316f}), {1, 0, 3.770658f}, 1e-6f);
    EXPECT_FALSE(MakeTestCamera("spherical")->NdcFromCamera());
    // The projected screen fills the unit square, with y up.
    ExpectClose(ndc.Point(RayAt(*camera, {30, 0}).ray(3)), {0.5f + 0.5f, 1, ndc.Point({0, 0, 2}).z}, 1e-2f);
}

}  // namespace
}  // namespace pbrt::test
