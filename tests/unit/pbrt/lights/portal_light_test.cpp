#include "light_test_support.h"
#include "pbrt/lights/infinite_lights.h"
#include "support/errors.h"

namespace pbrt::test {
namespace {

Rgb SkyBehindPortal(int x, int y) {
    if (x == 9 && y == 5) return {12, 9, 4};
    return {0.1f * Float(x), 0.4f, 0.05f * Float(y)};
}

/// A portal of 2 x 1 in the plane z = 1, visible from below (cross(p3 - p0, p1 - p0) is +z), and turned by kTurn.
const Transform kTurn = Transform::Translate({0.3f, -0.2f, 0.1f}) * Transform::Rotate(33, {1, 3, 2});
std::vector<Float> Corners(const Transform &turn = kTurn) {
    std::vector<Float> v;
    for (Point3 p : {Point3(-1, -0.5f, 1), Point3(-1, 0.5f, 1), Point3(1, 0.5f, 1), Point3(1, -0.5f, 1)}) {
        Point3 q = turn.Point(p);
        v.insert(v.end(), {q.x, q.y, q.z});
    }
    return v;
}

Params BehindPortal(Params sky) { return sky.Floats(ParamType::Point3, "portal", Corners()); }

class EnvironmentThroughPortal : public testing::Test {
  protected:
    EnvironmentThroughPortal() : file_("portal.exr", RgbImage({16, 16}, SkyBehindPortal)) {}
    Params File() const { return BehindPortal(FileParams(file_)); }
    std::unique_ptr<Light> MakeIt() const {
        auto light = Make("infinite", File().Number("scale", 0.8f), Transform::Rotate(40, {1, 2, 3}));
        light->Preprocess({0, 0, 0}, 5);
        return light;
    }
    /// True if the line from p along w goes through the portal: slow, but simple.
    static bool ThroughWindow(const Point3 &p, const Vector3 &w, Float margin) {
        Point3 o = kTurn.InversePoint(p);
        Vector3 d = kTurn.InverseVector(w);
        if (!(o.z < 1) || !(d.z > 0)) return false;
        Point3 hit = o + d * ((1 - o.z) / d.z);
        return std::abs(hit.x) < 1 + margin && std::abs(hit.y) < Float(0.5) + margin;
    }
    /// A point in a box of the portal's coordinates.
    static Point3 RandomPoint(Rng &rng, const Point3 &low, const Point3 &high) {
        const Float x = rng.Uniform(), y = rng.Uniform(), z = rng.Uniform();
        return kTurn.Point(low + (high - low) * Vector3(x, y, z));
    }
    TemporaryImage file_;
};

const Point3 kViewpoints[] = {Point3(0, 0, 0), Point3(0.2f, 0.1f, 0.9f), Point3(-2, 0.3f, -0.5f), Point3(3, 4, -12)};

TEST_F(EnvironmentThroughPortal, DirectionsFollowTheDensityAtTheirPoint) {
    auto light = MakeIt();
    for (const Point3 &place : kViewpoints) {
        Point3 p = kTurn.Point(place);
        constexpr int kSamples = 40000;
        int k = 0;
        const auto draw = [&](const Point2 &u) -> std::optional<Vector3> {
            const auto s = light->SampleLi(At(p), u, kLambda, ++k % 2 == 0);
            if (!s) return {};
            EXPECT_TRUE(ThroughWindow(p, s->wi, 1e-3f));
            return s->wi;
        };
        RectangleCounts counts = CountThroughRectangle(
            {kTurn.Vector({1, 0, 0}), kTurn.Vector({0, 1, 0}), kTurn.Vector({0, 0, 1})}, Vector3(-1, -0.5f, 1) - place,
            Vector3(1, 0.5f, 1) - place, kSamples, draw,
            [&](const Vector3 &w) { return light->PdfLi(At(p), w, {}, {}, true); }, 60);
        EXPECT_NEAR(counts.mass, 1, 1e-2) << "seen from z " << place.z;
        EXPECT_EQ(counts.observed.back(), 0);
        counts.expected.back() = 0;
        for (double &e : counts.expected) e /= counts.mass;
        EXPECT_GT(ChiSquareTest(counts.observed, counts.expected, 20), 1e-4) << place.z;
    }
}

TEST_F(EnvironmentThroughPortal, DensityAndRadianceOfASampleAreThoseOfItsDirection) {
    auto light = MakeIt();
    Rng rng(5);
    int same = 0, all = 0;
    for (int k = 0; k < 20000; ++k) {
        const Point3 p = RandomPoint(rng, {-3, -3, 0.9f}, {3, 3, -2.1f});
        auto s = light->SampleLi(At(p), rng.Uniform2(), kLambda, true);
        if (!s) continue;
        ++all;
        ASSERT_TRUE(std::isfinite(s->pdf) && s->pdf > 0);
        EXPECT_GE(Length(s->pLight - p), 9.9f);
        Float pdf = light->PdfLi(At(p), s->wi, {}, {}, true), L = light->Le(p, s->wi, kLambda).Average();
        // Rounding moves a few samples across the border of a pixel or of the portal.
        same += std::abs(pdf / s->pdf - 1) < 2e-2f && std::abs(L / s->L.Average() - 1) < 1e-3f;
    }
    EXPECT_GT(all, 15000);
    EXPECT_GT(same, 0.99 * all);
}

TEST_F(EnvironmentThroughPortal, LightComesOnlyThroughThePortalAndOnlyInwards) {
    auto light = MakeIt();
    Rng rng(6);
    int through = 0;
    for (int k = 0; k < 50000; ++k) {
        const Point3 p = RandomPoint(rng, {-3, -3, -2}, {3, 3, 2});
        Vector3 w = SampleUniformSphere(rng.Uniform2());
        if (ThroughWindow(p, w, 1e-3f) != ThroughWindow(p, w, -1e-3f)) continue;
        bool expected = ThroughWindow(p, w, 0);
        through += expected;
        ASSERT_EQ(bool(light->Le(p, w, kLambda)), expected);
        ASSERT_EQ(light->PdfLi(At(p), w, {}, {}, true) > 0, expected);
    }
    EXPECT_GT(through, 500);
    EXPECT_FALSE(light->SampleLi(At(kTurn.Point({0, 0, 1.1f})), {0.5f, 0.5f}, kLambda, true))
        << "the point is outside of the portal";
    EXPECT_FALSE(light->SampleLi(At(kTurn.Point({5, 0, 1})), {0.5f, 0.5f}, kLambda, true))
        << "the point is in the plane of the portal";
}

TEST_F(EnvironmentThroughPortal, RadianceIsThatOfTheEnvironmentBeyond) {
    // A smooth environment, which resampling changes little.
    TemporaryImage smooth("smooth.exr", RgbImage({64, 64}, [](int x, int y) {
                              const Vector3 w = EqualAreaSquareToSphere(PixelCenter(x, y, {64, 64}));
                              return Rgb(1 + 0.5f * w.x, 1 + 0.5f * w.y, 1 + 0.5f * w.z);
                          }));
    Transform ctm = Transform::Rotate(70, {2, 1, 0});
    auto open = Make("infinite", FileParams(smooth), ctm);
    auto portal = Make("infinite", BehindPortal(FileParams(smooth)), ctm);
    Rng rng(7);
    int seen = 0;
    for (int k = 0; k < 20000; ++k) {
        const Point3 p = RandomPoint(rng, {-1, -0.5f, 0.95f}, {1, 0.5f, -0.05f});
        Vector3 w = SampleUniformSphere(rng.Uniform2());
        if (!ThroughWindow(p, w, -1e-3f)) continue;
        ++seen;
        ASSERT_NEAR(portal->Le(p, w, kLambda).Average() / open->Le(p, w, kLambda).Average(), 1, 0.06);
    }
    EXPECT_GT(seen, 3000);
}

TEST_F(EnvironmentThroughPortal, PhiIsThePowerThroughThePortal) {
    auto light = MakeIt();
    // The power through the portal: radiance times cosine over the half-space just inside, times the area.
    Rng rng(8);
    RunningStatistics stats;
    for (int k = 0; k < 200000; ++k) {
        Vector3 w = SampleCosineHemisphere(rng.Uniform2());
        Point3 p = kTurn.Point(Point3(0, 0, 0.9999f));
        stats.Add(double(light->Le(p, Normalize(kTurn.Vector(w)), kLambda).Average()) * std::numbers::pi * 2);
    }
    double phi = light->Phi(kLambda).Average();
    EXPECT_NEAR(stats.mean, phi, 4.5 * stats.StandardError() + 2e-2 * phi);
}

TEST_F(EnvironmentThroughPortal, IsGivenInWorldSpaceAndStaysThereInAnyRenderingSpace) {
    auto light = MakeIt();
    DiagnosticSink sink;
    for (Transform renderFromWorld :
         {Transform::Rotate(50, {1, 0, 1}) * Transform::Translate({1, 2, 3}), Transform::Scale({-1, 1, 1})}) {
        auto moved = Make("infinite", File().Number("scale", 0.8f), renderFromWorld * Transform::Rotate(40, {1, 2, 3}),
                          renderFromWorld, sink);
        Rng rng(9);
        int seen = 0, same = 0;
        for (int k = 0; k < 4000; ++k) {
            const Point3 p = RandomPoint(rng, {-1, -0.5f, 1.5f}, {1, 0.5f, -0.5f});
            Vector3 w = SampleUniformSphere(rng.Uniform2());
            Float a = light->Le(p, w, kLambda).Average(),
                  b = moved->Le(renderFromWorld.Point(p), renderFromWorld.Vector(w), kLambda).Average();
            seen += a > 0;
            same += std::abs(a - b) <= 1e-3f * a;
        }
        EXPECT_GT(seen, 100);
        EXPECT_GT(same, 3980);
    }
}

TEST_F(EnvironmentThroughPortal, OpeningBoundsThePortalAndPointsInwards) {
    auto light = MakeIt();
    EXPECT_FALSE(light->Bounds()) << "for stock samplers a portal light is an infinite light without bounds";
    auto opening = light->AsEnvironment()->Opening();
    ASSERT_TRUE(opening);
    std::vector<Float> v = Corners();
    for (size_t i = 0; i < 12; i += 3) {
        Point3 p(v[i], v[i + 1], v[i + 2]);
        EXPECT_LT(Distance(p, glm::clamp(p, opening->bounds.low, opening->bounds.high)), 1e-5f);
    }
    EXPECT_NEAR(Dot(opening->w, Normalize(kTurn.Vector({0, 0, -1}))), 1, 1e-5);
    Rng rng(10);
    int lit = 0;
    for (int k = 0; k < 20000; ++k) {
        Point3 p = kTurn.Point(Point3(6 * rng.Uniform() - 3, 6 * rng.Uniform() - 3, 1 - 3 * Sqr(rng.Uniform())));
        auto s = light->SampleLi(At(p), rng.Uniform2(), kLambda, true);
        if (!s) continue;
        ++lit;
        ASSERT_GT(opening->Importance(p, Normal3(0)), 0);
    }
    EXPECT_GT(lit, 15000);
}

TEST(PortalIlluminance, IsMeasuredInTheOrderOfTheChannelsInTheFile) {
    const Rgb sky(0.2f, 0.5f, 1.1f), weights = ColorSpace::SRGB().Luminance();
    const Rgb reversed(weights.z, weights.y, weights.x);
    const Image image = RgbImage({64, 64}, [&](int, int) { return sky; });
    TemporaryImage exr("sky.exr", image), pfm("sky.pfm", image);
    const auto nits = [](Params params) {
        return Nits(*Make("infinite", params.Number("illuminance", 3)), kTurn.Vector({0, 0, 1}),
                    kTurn.Point(Point3(0)));
    };
    // As in stock pbrt-v4 without a portal, there is a factor of two: a uniform environment of luminance 1 counts as pi
    // / 2.
    auto expected = [&](const Rgb &counted) {
        const Float luminance = Dot(weights, sky), measured = Dot(counted, sky) * Pi / 2;
        return double(luminance * 3 / measured);
    };
    EXPECT_NEAR(nits(BehindPortal(FileParams(exr))), expected(reversed), 3e-3 * expected(reversed));
    EXPECT_NEAR(nits(BehindPortal(FileParams(pfm))), expected(weights), 3e-3 * expected(weights));
    EXPECT_NEAR(nits(FileParams(exr)), expected(weights), 3e-3 * expected(weights));
    EXPECT_GT(expected(weights) / expected(reversed), 1.2);
}

TEST(PortalOfOneColour, KeepsTheUnitsOfTheLight) {
    DiagnosticSink sink;
    const auto nits = [&](const Params &params) {
        auto light = Make("infinite", BehindPortal(params), {}, {}, sink);
        return Nits(*light, kTurn.Vector({0, 0, 1}), kTurn.Point(Point3(0)));
    };
    EXPECT_NEAR(nits(Params().Rgb("L", 3, 3, 3).Number("scale", 2)), 6, 0.02);
    EXPECT_TRUE(sink.All().empty());
    EXPECT_NEAR(nits(Params().Floats(ParamType::Blackbody, "L", {4000}).Number("scale", 2)), 2, 0.02);
    ASSERT_EQ(sink.All().size(), 1u);
    ExpectWords(sink.All()[0].message, {"colour"});
}

}  // namespace
}  // namespace pbrt::test
