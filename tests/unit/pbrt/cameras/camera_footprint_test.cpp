#include "camera_cases.h"
#include "pbrt/math/rng.h"

namespace pbrt::test {
namespace {

struct FootprintAt {
    Vector3 x{}, y{};
    FootprintAt(const Camera &camera, const Point3 &p, const Normal3 &n, int samples = 1) {
        camera.ApproximateFootprint(p, n, 0, samples, &x, &y);
    }
};

TEST(Footprint, FacingPlaneAtTheCornerHasTheSizeOfACornerPixel) {
    // The smallest angle between neighbouring rays is at the ends of the diagonal.
    auto camera = MakeTestCamera("perspective", Params().Number("fov", 60), {200, 200});
    CameraRay corner = RayAt(*camera, {0, 0});
    Float angleX = AngleBetween(corner.ray.d, corner.differential.rxDirection);
    Float angleY = AngleBetween(corner.ray.d, corner.differential.ryDirection);
    for (const Point3 &p :
         {Point3(0, 0, 10), Point3(6, -3, 5), Point3(0, 0, -10), Point3(3, 2, -7), Point3(-8, 0, 0)}) {
        const FootprintAt f(*camera, p, -Normalize(p));
        Float distance = Length(p);
        // The ray and its neighbour meet a plane that faces the ray; that is not quite symmetric about the step to the
        // neighbour.
        EXPECT_NEAR(Length(f.x) / (distance * std::tan(angleX)), 1, 0.02f);
        EXPECT_NEAR(Length(f.y) / (distance * std::tan(angleY)), 1, 0.02f);
        EXPECT_NEAR(Dot(f.x, p) / (Length(f.x) * distance), 0, 1e-3f);
        // On the diagonal the steps to the right and down are 60 to 120 degrees apart, not parallel.
        EXPECT_GT(Length(Cross(f.x, f.y)), 0.5f * Length(f.x) * Length(f.y));
    }
}

TEST(Footprint, LiesInTheTangentPlaneAndGrowsWithDistance) {
    auto camera = MakeTestCamera("perspective", Params(), {320, 200},
                                 Transform::Translate({3, 1, 2}) * Transform::Rotate(40, {1, 2, 3}));
    Rng rng(3);
    for (int i = 0; i < 300; ++i) {
        Vector3 toward = Normalize(Vector3(rng.Uniform() - 0.5f, rng.Uniform() - 0.5f, rng.Uniform() - 0.5f));
        Normal3 n = Normalize(toward + 0.6f * Normalize(Vector3(rng.Uniform() - 0.5f, rng.Uniform() - 0.5f, 0.3f)));
        Point3 eye = camera->CameraFromRender(0).InversePoint({0, 0, 0});
        const FootprintAt near(*camera, eye + 2.f * toward, n), far(*camera, eye + 20.f * toward, n);
        EXPECT_NEAR(Dot(near.x, n), 0, 2e-6f);
        EXPECT_NEAR(Dot(near.y, n), 0, 2e-6f);
        EXPECT_NEAR(Length(far.x) / Length(near.x), 10, 0.05f);
        EXPECT_NEAR(Length(far.y) / Length(near.y), 10, 0.05f);
        EXPECT_GT(Length(near.x), 0);
    }
}

TEST(Footprint, ShrinksWithTheSampleCountDownToAnEighth) {
    auto camera = MakeTestCamera("perspective");
    auto length = [&](int samples) { return Length(FootprintAt(*camera, {1, 2, 5}, {0, 0, -1}, samples).x); };
    Float one = length(1);
    EXPECT_GT(one, 0);
    EXPECT_NEAR(length(4) / one, 0.5f, 1e-5f);
    EXPECT_NEAR(length(64) / one, 0.125f, 1e-5f);
    EXPECT_NEAR(length(1000) / one, 0.125f, 1e-5f);
}

TEST(Footprint, DoesNotDependOnTheRenderingSpace) {
    Transform t = Transform::Translate({3, -4, 5}) * Transform::Rotate(123, {1, -2, 3});
    for (const char *type : {"perspective", "orthographic", "spherical"}) {
        auto a = MakeTestCamera(type, Params(), {30, 30}), b = MakeTestCamera(type, Params(), {30, 30}, t);
        Point3 p(1, 2, 5);
        Normal3 n = Normalize(Vector3(0.2f, 0.3f, -1));
        const FootprintAt plain(*a, p, n), moved(*b, t.Point(p), t.Normal(n));
        EXPECT_GT(Length(plain.x), 0);
        ExpectClose(moved.x, t.Vector(plain.x), 1e-4f * Length(plain.x) + 2e-6f, type);
        ExpectClose(moved.y, t.Vector(plain.y), 1e-4f * Length(plain.y) + 2e-6f, type);
    }
}

TEST(Footprint, OrthographicIsThePixel) {
    auto camera =
        MakeTestCamera("orthographic", Params().Floats(ParamType::Float, "screenwindow", {-2, 2, -1, 1}), {40, 10});
    const FootprintAt f(*camera, {0, 0, 7}, {0, 0, -1});
    ExpectClose(f.x, {0.1f, 0, 0}, 1e-6f);
    ExpectClose(f.y, {0, -0.2f, 0}, 1e-6f);
}

TEST(Footprint, IsZeroWithoutATangentPlane) {
    auto camera = MakeTestCamera("perspective");
    Vector3 dpdx(1), dpdy(1);
    camera->ApproximateFootprint({0, 0, 5}, {0, 0, 0}, 0, 1, &dpdx, &dpdy);
    EXPECT_EQ(dpdx, Vector3(0));
    EXPECT_EQ(dpdy, Vector3(0));
    camera->ApproximateFootprint({0, 0, 0}, {0, 0, 1}, 0, 1, &dpdx, &dpdy);
    EXPECT_EQ(dpdx, Vector3(0));
    // At points all around the camera, on surfaces seen edge-on, the footprint may be huge, but never NaN.
    Rng rng(4);
    for (int i = 0; i < 2000; ++i) {
        Point3 p(rng.Uniform() - 0.5f, rng.Uniform() - 0.5f, i % 2 ? -1 : 1e-4f);
        camera->ApproximateFootprint(p, Normalize(Cross(p, {0, 1, 0})), 0, 1, &dpdx, &dpdy);
        EXPECT_TRUE(std::isfinite(LengthSquared(dpdx)) || Length(dpdx) > 1e10f);
        EXPECT_FALSE(std::isnan(dpdx.x + dpdy.x));
    }
}

}  // namespace
}  // namespace pbrt::test
