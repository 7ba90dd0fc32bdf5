#include <numbers>

#include "camera_cases.h"
#include "lens_cases.h"
#include "pbrt/cameras/camera_kinds.h"
#include "pbrt/math/rng.h"
#include "support/errors.h"
#include "support/statistics.h"

namespace pbrt {
namespace {

using test::FloatParam;
using test::MakeTestCamera;
using test::RayAt;
using test::StringParam;

std::string LensText(const std::vector<LensElement> &elements) {
    std::string text;
    for (const LensElement &e : elements)
        text += fmt::format("{} {} {} {}\n", e.curvatureRadius * 1000, e.thickness * 1000, e.IsStop() ? 0 : e.index,
                            e.apertureRadius * 2000);
    return text;
}

std::vector<Param> Parameters(const std::vector<LensElement> &elements, Float focus, Float aperture = 14) {
    return {StringParam("lensfile", test::WriteFile("camera_test_lens.dat", LensText(elements))),
            FloatParam("focusdistance", {focus}), FloatParam("aperturediameter", {aperture})};
}

RealisticCamera &Realistic(Camera &camera) { return static_cast<RealisticCamera &>(camera); }

TEST(RealisticCamera, RaysOfAPixelMeetWhereItIsInFocus) {
    auto camera = MakeTestCamera("realistic", Parameters(test::ThinLens(0.05f, 0.004f), 2), {60, 40});
    Rng rng(1);
    // A thin lens maps the film, upside down, to the plane at 2 m from the film.
    const Float s = Realistic(*camera).Lens().RearZ();
    for (const Point2 &raster : {Point2(30, 20), Point2(10, 30), Point2(55, 5)}) {
        const Point2 film = Realistic(*camera).FilmFromRaster(raster);
        for (int i = 0; i < 50; ++i) {
            auto ray = camera->GenerateRay({raster, rng.Uniform2() * 0.4f + Point2(0.3f), 0, 1}, {});
            ASSERT_TRUE(ray);
            // Oblique rays focus in front of the plane: a real lens has field curvature.
            const Point3 expected(film * (-(2 - s) / s), 2);
            test::ExpectClose(test::AtDepth(ray->ray, 2), expected,
                              0.005f + 0.05f * glm::length(Point2(expected.x, expected.y)));
        }
    }
}

TEST(RealisticCamera, PicturesAreUprightAndFilmHasItsDiagonal) {
    auto camera = MakeTestCamera("realistic", Parameters(test::DoubleGauss(), 6), {60, 40});
    EXPECT_LT(RayAt(*camera, {10, 20}).ray.d.x, 0) << "left";
    EXPECT_GT(RayAt(*camera, {50, 20}).ray.d.x, 0) << "right";
    EXPECT_GT(RayAt(*camera, {30, 10}).ray.d.y, 0) << "top";
    EXPECT_LT(RayAt(*camera, {30, 30}).ray.d.y, 0) << "bottom";
    const Point2 corner = Realistic(*camera).FilmFromRaster({0, 0}),
                 other = Realistic(*camera).FilmFromRaster({60, 40});
    EXPECT_NEAR(glm::length(corner - other), 0.035f, 1e-6f);
    EXPECT_NEAR(std::abs(corner.x / corner.y), 1.5f, 1e-5f);
}

/// The mean ray weight at a film point, with its standard error: the irradiance in a world of radiance 1, times the
/// exposure parameters.
test::RunningStatistics Exposure(const Camera &camera, const Point2 &raster, int samples = 20000) {
    Rng rng(5);
    test::RunningStatistics stats;
    for (int i = 0; i < samples; ++i) {
        auto ray = camera.GenerateRay({raster, rng.Uniform2(), 0, 1}, {});
        stats.Add(ray ? double(ray->weight[0]) : 0);
    }
    return stats;
}

TEST(RealisticCamera, ExposureIsThatOfTheApertureOnTheAxisAndFallsByCos4) {
    // A thin lens with its rim as the stop: light arrives in the cone from the film point to the rim.
    const Float radius = 0.004f;
    const std::vector<LensElement> elements = test::ThinLens(0.05f, radius);
    auto camera = MakeTestCamera("realistic", Parameters(elements, 10), {60, 40});
    const double z = double(Realistic(*camera).Lens().RearZ()) + ComputeCardinalPoints(elements).rearPrincipal;
    const double onAxis = std::numbers::pi * double(Sqr(radius)) / (z * z + double(Sqr(radius)));
    for (const Point2 &raster : {Point2(30, 20), Point2(60, 20), Point2(0, 40)}) {
        const test::RunningStatistics e = Exposure(*camera, raster);
        const double cosine2 = z * z /
                               (z * z + double(glm::dot(Realistic(*camera).FilmFromRaster(raster),
                                                        Realistic(*camera).FilmFromRaster(raster))));
        EXPECT_NEAR(e.mean, onAxis * cosine2 * cosine2, 4.5 * e.StandardError() + 0.01 * onAxis) << raster.x;
        EXPECT_GT(e.mean, 0);
    }
}

TEST(RealisticCamera, VignettingIsTheShareOfTheRimsThatOverlap) {
    // Sampling the rectangle of the pupil must give the same as sampling everything behind the rear element.
    auto camera = MakeTestCamera("realistic", Parameters(test::FishEye(), 3, 8), {60, 40});
    const LensSystem &lens = Realistic(*camera).Lens();
    double darkest = 1e9, brightest = 0;
    for (const Point2 &raster : {Point2(30, 20), Point2(45, 20), Point2(57, 38)}) {
        const Point2 film = Realistic(*camera).FilmFromRaster(raster);
        Rng rng(6);
        test::RunningStatistics slow;
        const Float side = 3 * lens.RearRadius();
        for (int i = 0; i < 200000; ++i) {
            Ray ray;
            ray.o = Point3(film, 0);
            ray.d = Normalize(Point3((rng.Uniform2() - Point2(0.5f)) * side, lens.RearZ()) - ray.o);
            const double cosine2 = double(Sqr(ray.d.z));
            slow.Add(double(lens.Trace(&ray)) * cosine2 * cosine2 * double(Sqr(side) / Sqr(lens.RearZ())));
        }
        const test::RunningStatistics fast = Exposure(*camera, raster);
        EXPECT_NEAR(fast.mean, slow.mean, 4.5 * std::hypot(fast.StandardError(), slow.StandardError()));
        EXPECT_LT(fast.StandardError() * std::sqrt(20000), slow.StandardError() * std::sqrt(200000));
        darkest = std::min(darkest, slow.mean);
        brightest = std::max(brightest, slow.mean);
    }
    EXPECT_LT(darkest, 0.6 * brightest);
    EXPECT_GT(darkest, 0);
}

TEST(RealisticCamera, ShapedAperturesExposeAsTheDisk) {
    const std::vector<Param> round = Parameters(test::DoubleGauss(), 6, 8);
    auto disk = MakeTestCamera("realistic", round, {60, 40});
    for (const char *shape : {"gaussian", "square", "pentagon", "star"}) {
        std::vector<Param> params = round;
        params.push_back(StringParam("aperture", shape));
        auto shaped = MakeTestCamera("realistic", params, {60, 40});
        for (const Point2 &raster : {Point2(30, 20), Point2(40, 30)}) {  // the second one is on the diagonal
            const test::RunningStatistics a = Exposure(*disk, raster), b = Exposure(*shaped, raster);
            EXPECT_NEAR(b.mean / a.mean, 1, 0.02 + 4.5 * b.StandardError() / a.mean) << shape << " " << raster.x;
        }
    }
}

TEST(RealisticCamera, DifferentialsAreTheRaysOfTheNextPixels) {
    auto camera = MakeTestCamera("realistic", Parameters(test::DoubleGauss(), 6), {600, 400});
    const LensSystem &lens = Realistic(*camera).Lens();
    const CardinalPoints cardinal = ComputeCardinalPoints(test::DoubleGauss());
    const auto magnification =
        Float((6 - double(lens.FrontZ()) + cardinal.frontPrincipal) / (double(lens.RearZ()) + cardinal.rearPrincipal));
    const Float pixel = 0.035f / glm::length(Vector2(600, 400)) * magnification;
    Rng rng(7);
    int valid = 0;
    for (int i = 0; i < 200; ++i) {
        const Point2 raster = rng.Uniform2() * Point2(500, 300) + Point2(50);
        auto c = camera->GenerateRay({raster, Point2(0.5f), 0, 1}, {});
        ASSERT_TRUE(c);
        if (!c->differential.valid) continue;
        ++valid;
        // In focus, the points that neighbouring pixels see are next to each other.
        Ray x, y;
        x.o = c->differential.rxOrigin;
        x.d = c->differential.rxDirection;
        y.o = c->differential.ryOrigin;
        y.d = c->differential.ryDirection;
        EXPECT_NEAR(Distance(test::AtDepth(x, 6), test::AtDepth(c->ray, 6)), pixel, 0.15f * pixel);
        EXPECT_NEAR(Distance(test::AtDepth(y, 6), test::AtDepth(c->ray, 6)), pixel, 0.15f * pixel);
        EXPECT_GT(test::AtDepth(x, 6).x, test::AtDepth(c->ray, 6).x);
        EXPECT_LT(test::AtDepth(y, 6).y, test::AtDepth(c->ray, 6).y);
    }
    EXPECT_EQ(valid, 200);
    Vector3 dpdx, dpdy;
    camera->ApproximateFootprint({0, 0, 6}, {0, 0, -1}, 0, 1, &dpdx, &dpdy);
    EXPECT_NEAR(Length(dpdx) / pixel, 1, 0.25f);
}

std::string RealisticErrorOf(const std::vector<Param> &params) {
    return test::MessageOf([&] { MakeTestCamera("realistic", params); });
}

TEST(RealisticCamera, BadInputIsAnError) {
    test::ExpectWords(RealisticErrorOf({}), {"lensfile"});
    test::ExpectWords(RealisticErrorOf({StringParam("lensfile", "/nowhere/lens.dat")}), {"/nowhere/lens.dat"});
    test::ExpectWords(RealisticErrorOf(Parameters(test::DoubleGauss(), 0.1f)), {"focus"});
    test::ExpectWords(RealisticErrorOf(Parameters(test::DoubleGauss(), 6, 0)), {"aperturediameter"});
    std::vector<Param> params = Parameters(test::DoubleGauss(), 6);
    params.push_back(StringParam("aperture", "hexagon"));
    test::ExpectWords(RealisticErrorOf(params), {"pentagon"});
}

TEST(RealisticCamera, StopsOpenNoFartherThanTheyCan) {
    DiagnosticSink sink;
    auto wide = MakeTestCamera("realistic", Parameters(test::DoubleGauss(), 6, 50), {6, 4}, {}, &sink);
    ASSERT_EQ(sink.All().size(), 1u);
    EXPECT_EQ(sink.All()[0].severity, Severity::Warning);
    auto open = MakeTestCamera("realistic", Parameters(test::DoubleGauss(), 6, 14), {6, 4}, {}, &sink);
    EXPECT_EQ(sink.All().size(), 1u);
    EXPECT_EQ(Realistic(*wide).Pupil().Bounds(0).Area(), Realistic(*open).Pupil().Bounds(0).Area());
}

}  // namespace
}  // namespace pbrt
