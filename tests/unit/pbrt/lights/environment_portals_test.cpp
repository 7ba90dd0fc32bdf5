#include "pbrt/lights/environment_portals.h"

#include "light_test_support.h"

namespace pbrt::test {
namespace {

struct Sky {
    const char *name;
    std::function<Rgb(int, int)> color;  ///< by pixel; empty: one colour, without an image
    int resolution = 0;
};
const Sky kSkies[] = {{"one_colour", nullptr, 0},
                      {"gradient", [](int x, int y) { return Rgb(0.1f * Float(x + 1), 0.4f, 0.05f * Float(y)); }, 12},
                      {"one_bright_pixel", [](int x, int y) { return x == 5 && y == 8 ? Rgb(800) : Rgb(0.1f); }, 16},
                      {"half_black", [](int, int y) { return Rgb(y < 8 ? 0.f : 1.f); }, 16}};

/// Two portals in a wall, one before the first of them that hides a part of it, and one in a slanted wall.
std::vector<Portal> Portals() {
    const Frame wall{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}};
    const Frame slanted = Frame::FromXZ({0, 1, 0}, Normalize(Vector3(2, 0.3f, 1)));
    return {{wall, {0.2f, -1.5f, 2}, {1, -0.5f, 2}},
            {wall, {1.5f, -1.5f, 2}, {2.5f, -0.2f, 2}},
            {wall, {0.4f, -2, 1.5f}, {0.8f, 0, 1.5f}},
            {slanted, {-1, -2, 3}, {1, 1, 3}}};
}
const Point3 kPlaces[] = {{0.5f, 0.2f, 0.4f}, {2, -3, 1}, {-1, 1.4f, 0}, {0.9f, 1.999f, 1}};

class PortalsOfEnvironments : public testing::TestWithParam<Sky> {
  protected:
    void SetUp() override {
        Params params;
        if (GetParam().color) {
            file_.emplace("portals.exr", RgbImage(Point2i(GetParam().resolution), GetParam().color));
            params = FileParams(*file_);
        }
        light = Make("infinite", params, Transform::Rotate(70, {1, -2, 1}));
        light->Preprocess({0, 0, 0}, 5);
        portals.emplace(*light->AsEnvironment(), Portals());
    }
    std::optional<LightLiSample> SampleRegion(size_t region, const Point3 &p, const Point2 &u, bool incomplete = true) {
        return portals->SampleLi(region, At(p), u, kLambda, incomplete);
    }
    Float RegionPdf(size_t region, const Point3 &p, const Vector3 &wi, bool incomplete = true) {
        return portals->PdfLi(region, At(p), wi, incomplete);
    }

    std::unique_ptr<Light> light;
    std::optional<EnvironmentPortals> portals;

  private:
    std::optional<TemporaryImage> file_;
};

/// By cells of the portal's plane. Draws that give nothing are counted, too: the integral of the density over what is
/// not black is the probability that a draw gives something.
TEST_P(PortalsOfEnvironments, DirectionsFollowTheDensity) {
    constexpr int kDraws = 20000;
    size_t tested = 0;
    for (const Point3 &p : kPlaces)
        for (size_t part = 0; part < portals->Count(); ++part) {
            const Portal &portal = (*portals)[part];
            const Vector3 at = portal.frame.ToLocal(p), low = portal.low - at;
            if (!(low.z > 0.1f)) continue;  // nearer, cells are too wide
            const auto densityAt = [&](const Vector3 &wi) {
                return light->Le(p, wi, kLambda) ? RegionPdf(part, p, wi) : Float(0);
            };
            int elsewhere = 0;  // rounding carries directions over borders of pixels
            const auto draw = [&](const Point2 &u) -> std::optional<Vector3> {
                const auto s = SampleRegion(part, p, u);
                if (!s) return {};
                elsewhere += std::abs(densityAt(s->wi) / s->pdf - 1) > 1e-2f;
                return s->wi;
            };
            const RectangleCounts counts =
                CountThroughRectangle(portal.frame, low, portal.high - at, kDraws, draw, densityAt);
            EXPECT_LT(elsewhere, kDraws / 500) << "place " << p.x << ", " << part;
            EXPECT_LT(counts.mass, 1.01);
            if (counts.mass < 0.1) continue;  // black, or behind other portals
            ++tested;
            EXPECT_GT(ChiSquareTest(counts.observed, counts.expected, 40), SidakAlpha(1e-4, 64))
                << "place " << p.x << ", " << part;
        }
    EXPECT_GE(tested, 4u);
}

TEST_P(PortalsOfEnvironments, ComponentsAddUpToTheLight) {
    for (const Point3 &p : kPlaces) {
        // What each part brings, by its own samples and by directions drawn evenly.
        std::vector<RunningStatistics> bySamples(portals->Count()), byDirections(portals->Count());
        Rng rng(7);
        constexpr int kSamples = 40000;
        for (size_t part = 0; part < portals->Count(); ++part)
            for (int i = 0; i < kSamples; ++i) {
                const auto s = SampleRegion(part, p, rng.Uniform2());
                bySamples[part].Add(s ? double(s->L.Average() / s->pdf) : 0);
                if (s && portals->RegionTowards(p, s->wi) != part) FAIL() << "A direction is of another part.";
            }
        for (int i = 0; i < 20 * kSamples; ++i) {
            const Vector3 w = SampleUniformSphere(rng.Uniform2());
            const size_t part = portals->RegionTowards(p, w);
            const double value = double(light->Le(p, w, kLambda).Average() * 4 * Pi);
            for (size_t k = 0; k < portals->Count(); ++k) byDirections[k].Add(k == part ? value : 0);
        }
        for (size_t k = 0; k < portals->Count(); ++k) {
            const double error = std::hypot(bySamples[k].StandardError(), byDirections[k].StandardError());
            EXPECT_NEAR(bySamples[k].mean, byDirections[k].mean, 5 * error + 1e-4 * byDirections[k].mean)
                << "place " << p.x << ", part " << k;
        }
    }
}

TEST_P(PortalsOfEnvironments, TheRestIsWhatNoPortalShows) {
    const size_t rest = portals->Count();
    Rng rng(11);
    int found = 0;
    for (int i = 0; i < 2000; ++i) {
        const Point2 u = rng.Uniform2();
        const auto whole = light->SampleLi(At(kPlaces[0]), u, kLambda, false, 0);
        const auto s = SampleRegion(rest, kPlaces[0], u, false);
        ASSERT_TRUE(whole.has_value());
        ASSERT_EQ(s.has_value(), portals->RegionTowards(kPlaces[0], whole->wi) == rest);
        EXPECT_EQ(RegionPdf(rest, kPlaces[0], whole->wi, false), s ? s->pdf : 0);
        found += s.has_value();
    }
    EXPECT_GT(found, 100);
}

TEST_P(PortalsOfEnvironments, TheIntegralIsThatOfTheRadianceInThePortal) {
    Rng rng(13);
    for (size_t k : {size_t{0}, size_t{1}, size_t{3}}) {
        const Portal &portal = (*portals)[k];
        RunningStatistics sum;
        for (int i = 0; i < 400000; ++i) {
            const Vector3 w = SampleUniformSphere(rng.Uniform2());
            sum.Add(portal.IsPassed(kPlaces[0], w) ? double(light->AsEnvironment()->MeanRadiance(w) * 4 * Pi) : 0);
        }
        const std::optional<Bounds2> window = portal.WindowFrom(kPlaces[0]);
        const Float integral = window ? portals->Map(k).Integral(*window) : Float(0);
        EXPECT_NEAR(integral, sum.mean, 5 * sum.StandardError() + 0.02 * sum.mean) << k;
    }
}

/// Within a portal samples follow the radiance: what they bring hardly varies.
TEST_P(PortalsOfEnvironments, SamplesAreAlike) {
    const std::vector<Portal> one{{Frame{}, {-3, -3, 1}, {3, 3, 1}}};
    const EnvironmentPortals wide(*light->AsEnvironment(), one);
    Rng rng(17);
    RunningStatistics value;
    double greatest = 0;
    for (int i = 0; i < 20000; ++i) {
        const auto s = wide.Sample(0, {0, 0, 0}, rng.Uniform2());
        if (!s) continue;
        const double v = double(light->AsEnvironment()->MeanRadiance(s->wi) / s->pdf);
        value.Add(v);
        greatest = std::max(greatest, v);
    }
    ASSERT_GT(value.n, 1000u);
    EXPECT_LT(value.Variance(), 0.1 * value.mean * value.mean);
    EXPECT_LT(greatest, 12 * value.mean);
}

/// A sun as small as a pixel of the sky, and a portal before it.
class SmallSun : public testing::Test {
  public:
    Vector3 Sun() const { return turned.Vector(EqualAreaSquareToSphere(Point2(70.5f, 81.5f) / 128.f)); }
    static EnvironmentPortals Before(const Light &light, const Vector3 &z) {
        const std::vector<Portal> one{{Frame::FromZ(Normalize(z)), {-1, -1, 1}, {1, 1, 1}}};
        return {*light.AsEnvironment(), one};
    }
    const Transform turned = Transform::Rotate(40, {1, -2, 1});
    const TemporaryImage file{
        "sun.exr", RgbImage(Point2i(128), [](int x, int y) { return x == 70 && y == 81 ? Rgb(1e5f) : Rgb(0.1f); })};
    const std::unique_ptr<Light> light = Make("infinite", FileParams(file), turned);
};

/// The sun has a rim in every pixel of the map: these are divided.
TEST_F(SmallSun, TheRimMakesLittleNoise) {
    const EnvironmentPortals portals = Before(*light, Sun() + Vector3(0.1f, 0.2f, 0));
    Rng rng(19);
    RunningStatistics value;
    for (int i = 0; i < 20000; ++i) {
        const auto s = portals.Sample(0, {0, 0, 0}, rng.Uniform2());
        value.Add(s ? double(light->AsEnvironment()->MeanRadiance(s->wi) / s->pdf) : 0);
    }
    // Divided pixels leave 0.17, undivided ones 2.1.
    EXPECT_LT(value.Variance(), 0.5 * value.mean * value.mean);
}

/// However the sun's corners reach into pixels of the map, no direction in it is drawn so rarely that it is a firefly.
TEST_F(SmallSun, HasNoFireflies) {
    const Vector3 sun = Sun();
    const Frame around = Frame::FromZ(sun);
    Rng rng(23);
    int inSun = 0;
    for (int frame = 0; frame < 12; ++frame) {
        const EnvironmentPortals portals =
            Before(*light, sun + Vector3(rng.Uniform(), rng.Uniform(), rng.Uniform()) * Float(0.6));
        const Float integral = portals.Map(0).Integral(portals[0].WindowFrom({0, 0, 0}).value());
        for (int i = 0; i < 20000; ++i) {
            const Point2 at = (rng.Uniform2() - Point2(0.5f)) * Float(0.1);
            const Vector3 d = around.FromLocal(Normalize(Vector3(at, 1)));
            const Float radiance = light->AsEnvironment()->MeanRadiance(d);
            if (radiance < 1000) continue;
            ++inSun;
            ASSERT_LT(radiance, 9 * integral * portals.Pdf(0, {0, 0, 0}, d)) << frame;
        }
    }
    EXPECT_GT(inSun, 1000);
}

INSTANTIATE_TEST_SUITE_P(Lights, PortalsOfEnvironments, testing::ValuesIn(kSkies),
                         [](const auto &c) { return c.param.name; });

}  // namespace
}  // namespace pbrt::test
