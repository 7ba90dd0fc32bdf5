#include <numbers>

#include "camera_cases.h"
#include "lens_cases.h"
#include "support/errors.h"
#include "support/statistics.h"

namespace pbrt::test {
namespace {

std::string LensText(const std::vector<LensElement> &elements) {
    std::string text;
    for (const LensElement &e : elements)
        text += fmt::format("{} {} {} {}\n", e.curvatureRadius * 1000, e.thickness * 1000, e.IsStop() ? 0 : e.index,
                            e.apertureRadius * 2000);
    return text;
}

Params Parameters(const std::vector<LensElement> &elements, Float focus, Float aperture = 14) {
    return Params()
        .String("lensfile", WriteFile("camera_test_lens.dat", LensText(elements)))
        .Number("focusdistance", focus)
        .Number("aperturediameter", aperture);
}

std::unique_ptr<RealisticCamera> MakeRealistic(const ParamSet &params, Point2i resolution = {60, 40},
                                               DiagnosticSink *sink = nullptr) {
    auto camera = MakeTestCamera("realistic", params, resolution, {}, sink);
    return std::unique_ptr<RealisticCamera>(static_cast<RealisticCamera *>(camera.release()));
}

TEST(RealisticCamera, RaysOfAPixelMeetWhereItIsInFocus) {
    auto camera = MakeRealistic(Parameters(ThinLens(0.05f, 0.004f), 2));
    Rng rng(1);
    // A thin lens maps the film, upside down, to the plane at 2 m from the film.
    const Float s = camera->Lens().RearZ();
    for (const Point2 &raster : {Point2(30, 20), Point2(10, 30), Point2(55, 5)}) {
        const Point2 film = camera->FilmFromRaster(raster);
        for (int i = 0; i < 50; ++i) {
            auto ray = camera->GenerateRay({raster, rng.Uniform2() * 0.4f + Point2(0.3f), 0, 1}, {});
            ASSERT_TRUE(ray);
            // Oblique rays focus in front of the plane: a real lens has field curvature.
            const Point3 expected(film * (-(2 - s) / s), 2);
            ExpectClose(AtDepth(ray->ray, 2), expected, 0.005f + 0.05f * glm::length(Point2(expected.x, expected.y)));
        }
    }
}

TEST(RealisticCamera, PicturesAreUprightAndFilmHasItsDiagonal) {
    auto camera = MakeRealistic(Parameters(DoubleGauss(), 6));
    EXPECT_LT(RayAt(*camera, {10, 20}).ray.d.x, 0) << "left";
    EXPECT_GT(RayAt(*camera, {50, 20}).ray.d.x, 0) << "right";
    EXPECT_GT(RayAt(*camera, {30, 10}).ray.d.y, 0) << "top";
    EXPECT_LT(RayAt(*camera, {30, 30}).ray.d.y, 0) << "bottom";
    const Point2 corner = camera->FilmFromRaster({0, 0}), other = camera->FilmFromRaster({60, 40});
    EXPECT_NEAR(glm::length(corner - other), 0.035f, 1e-6f);
    EXPECT_NEAR(std::abs(corner.x / corner.y), 1.5f, 1e-5f);
}

/// The mean ray weight at a film point, with its standard error: the irradiance in a world of radiance 1, times the
/// exposure parameters.
RunningStatistics Exposure(const Camera &camera, const Point2 &raster, int samples = 20000) {
    Rng rng(5);
    RunningStatistics stats;
    for (int i = 0; i < samples; ++i) {
        auto ray = camera.GenerateRay({raster, rng.Uniform2(), 0, 1}, {});
        stats.Add(ray ? double(ray->weight[0]) : 0);
    }
    return stats;
}

TEST(RealisticCamera, ExposureIsThatOfTheApertureOnTheAxisAndFallsByCos4) {
    // A thin lens with its rim as the stop: light arrives in the cone from the film point to the rim.
    const Float radius = 0.004f;
    const std::vector<LensElement> elements = ThinLens(0.05f, radius);
    auto camera = MakeRealistic(Parameters(elements, 10));
    const double z = double(camera->Lens().RearZ()) + ComputeCardinalPoints(elements).rearPrincipal;
    const double onAxis = std::numbers::pi * double(Sqr(radius)) / (z * z + double(Sqr(radius)));
    for (const Point2 &raster : {Point2(30, 20), Point2(60, 20), Point2(0, 40)}) {
        const RunningStatistics e = Exposure(*camera, raster);
        const Point2 film = camera->FilmFromRaster(raster);
        const double cosine2 = z * z / (z * z + double(glm::dot(film, film)));
        EXPECT_NEAR(e.mean, onAxis * cosine2 * cosine2, 4.5 * e.StandardError() + 0.01 * onAxis) << raster.x;
        EXPECT_GT(e.mean, 0);
    }
}

TEST(RealisticCamera, VignettingIsTheShareOfTheRimsThatOverlap) {
    // Sampling the rectangle of the pupil must give the same as sampling everything behind the rear element.
    auto camera = MakeRealistic(Parameters(FishEye(), 3, 8));
    const LensSystem &lens = camera->Lens();
    double darkest = 1e9, brightest = 0;
    for (const Point2 &raster : {Point2(30, 20), Point2(45, 20), Point2(57, 38)}) {
        const Point2 film = camera->FilmFromRaster(raster);
        Rng rng(6);
        RunningStatistics slow;
        const Float side = 3 * lens.RearRadius();
        for (int i = 0; i < 200000; ++i) {
            Ray ray = FromFilm(film, RandomInSquare(rng, side / 2), lens);
            const double cosine2 = double(Sqr(ray.d.z));
            slow.Add(double(lens.Trace(&ray)) * cosine2 * cosine2 * double(Sqr(side) / Sqr(lens.RearZ())));
        }
        const RunningStatistics fast = Exposure(*camera, raster);
        EXPECT_NEAR(fast.mean, slow.mean, 4.5 * std::hypot(fast.StandardError(), slow.StandardError()));
        EXPECT_LT(fast.StandardError() * std::sqrt(20000), slow.StandardError() * std::sqrt(200000));
        darkest = std::min(darkest, slow.mean);
        brightest = std::max(brightest, slow.mean);
    }
    EXPECT_LT(darkest, 0.6 * brightest);
    EXPECT_GT(darkest, 0);
}

TEST(RealisticCamera, ShapedAperturesExposeAsTheDisk) {
    const Params round = Parameters(DoubleGauss(), 6, 8);
    auto disk = MakeRealistic(round);
    for (const char *shape : {"gaussian", "square", "pentagon", "star"}) {
        auto shaped = MakeRealistic(Params(round).String("aperture", shape));
        for (const Point2 &raster : {Point2(30, 20), Point2(40, 30)}) {  // the second one is on the diagonal
            const RunningStatistics a = Exposure(*disk, raster), b = Exposure(*shaped, raster);
            EXPECT_NEAR(b.mean / a.mean, 1, 0.02 + 4.5 * b.StandardError() / a.mean) << shape << " " << raster.x;
        }
    }
}

TEST(RealisticCamera, DifferentialsAreTheRaysOfTheNextPixels) {
    auto camera = MakeRealistic(Parameters(DoubleGauss(), 6), {600, 400});
    const LensSystem &lens = camera->Lens();
    const CardinalPoints cardinal = ComputeCardinalPoints(DoubleGauss());
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
        const Ray x{c->differential.rxOrigin, c->differential.rxDirection},
            y{c->differential.ryOrigin, c->differential.ryDirection};
        EXPECT_NEAR(Distance(AtDepth(x, 6), AtDepth(c->ray, 6)), pixel, 0.15f * pixel);
        EXPECT_NEAR(Distance(AtDepth(y, 6), AtDepth(c->ray, 6)), pixel, 0.15f * pixel);
        EXPECT_GT(AtDepth(x, 6).x, AtDepth(c->ray, 6).x);
        EXPECT_LT(AtDepth(y, 6).y, AtDepth(c->ray, 6).y);
    }
    EXPECT_EQ(valid, 200);
    Vector3 dpdx, dpdy;
    camera->ApproximateFootprint({0, 0, 6}, {0, 0, -1}, 0, 1, &dpdx, &dpdy);
    EXPECT_NEAR(Length(dpdx) / pixel, 1, 0.25f);
}

std::string RealisticError(const ParamSet &params) {
    return MessageOf([&] { MakeRealistic(params); });
}

TEST(RealisticCamera, BadInputIsAnError) {
    ExpectWords(RealisticError(Params()), {"lensfile"});
    ExpectWords(RealisticError(Params().String("lensfile", "/nowhere/lens.dat")), {"/nowhere/lens.dat"});
    ExpectWords(RealisticError(Parameters(DoubleGauss(), 0.1f)), {"focus"});
    ExpectWords(RealisticError(Parameters(DoubleGauss(), 6, 0)), {"aperturediameter"});
    ExpectWords(RealisticError(Parameters(DoubleGauss(), 6).String("aperture", "hexagon")), {"pentagon"});
}

TEST(RealisticCamera, ParametersOfAStopThatIsMissingHaveAWarning) {
    const std::vector<LensElement> biconvex = {{0.1f, 0.001f, 1.5f, 0.01f}, {-0.1f, 0.05f, 1, 0.01f}};
    DiagnosticSink sink;
    MakeRealistic(Parameters(biconvex, 6).String("aperture", "star"), {6, 4}, &sink);
    ASSERT_EQ(sink.All().size(), 2u);
    ExpectWords(sink.All()[0].message, {"\"aperturediameter\" has no effect: the lens has no stop"});
    ExpectWords(sink.All()[1].message, {"\"aperture\" has no effect"});
    EXPECT_FALSE(sink.HasErrors());
}

TEST(RealisticCamera, StopsOpenNoFartherThanTheyCan) {
    DiagnosticSink sink;
    auto wide = MakeRealistic(Parameters(DoubleGauss(), 6, 50), {6, 4}, &sink);
    ASSERT_EQ(sink.All().size(), 1u);
    EXPECT_EQ(sink.All()[0].severity, Severity::Warning);
    auto open = MakeRealistic(Parameters(DoubleGauss(), 6, 14), {6, 4}, &sink);
    EXPECT_EQ(sink.All().size(), 1u);
    EXPECT_EQ(wide->Pupil().Bounds(0).Area(), open->Pupil().Bounds(0).Area());
}

}  // namespace
}  // namespace pbrt::test
