#include "light_test_support.h"
#include "unit/pbrt/bxdfs/sphere_histogram.h"

namespace pbrt::test {
namespace {

Rgb SkyWithSun(int x, int y) {
    if (x == 3 && y == 5) return {80, 60, 30};
    return {0.1f * Float(x), 0.4f, 0.05f * Float(y)};
}

TEST(UniformInfiniteLight, ScaleOneIsOneNitAndIlluminanceIsThatOfAHemisphere) {
    auto one = Make("infinite", Params());
    auto lit = Make("infinite", Params().Rgb("L", 1, 1, 1).Number("illuminance", 1.7f).Number("scale", 1.1f));
    EXPECT_NEAR(Nits(*one), 1, 2e-3);
    EXPECT_NEAR(Nits(*lit) * std::numbers::pi, 1.7 * 1.1, 1e-2);
}

TEST(UniformInfiniteLight, LeavesSamplingToTheBsdfIfPdfsMayBeIncomplete) {
    auto light = Make("infinite", Params());
    light->Preprocess({1, 2, 3}, 4);
    EXPECT_FALSE(light->SampleLi(At({0, 0, 0}), {0.2f, 0.3f}, kLambda, true));
    EXPECT_EQ(light->PdfLi(At({0, 0, 0}), {0, 0, 1}, {}, {}, true), 0);
    auto s = light->SampleLi(At({0, 0, 0}), {0.2f, 0.3f}, kLambda, false);
    ASSERT_TRUE(s);
    EXPECT_EQ(s->pdf, light->PdfLi(At({0, 0, 0}), s->wi, {}, {}, false));
    EXPECT_GE(Length(s->pLight), 8 * 0.999f);
    double L = double(s->L.Average());
    EXPECT_NEAR(light->Phi(kLambda).Average(), L * 4 * std::numbers::pi * std::numbers::pi * 16, 1e-2 * L);
}

TEST(InfiniteLight, DirectionsFollowTheDensity) {
    // Every sky is tested with several transforms. The density of image lights jumps at pixel borders, so its integral
    // over a cell is only known to a per cent, unless the grid is finer.
    struct Case {
        const char *name;
        std::function<Rgb(int, int)> color;  // empty: a light of one colour, without an image
        int resolution;
        bool isCompensated = false;
        int fine = 0;
    };
    const Case cases[] = {{"one colour", nullptr, 0},
                          {"half black", [](int, int y) { return Rgb(y < 8 ? 0.f : 1.f); }, 16},
                          {"checks", [](int x, int y) { return Rgb((x + y) % 2 ? 0.2f : 1.f); }, 4},
                          {"one pixel", [](int, int) { return Rgb(0.3f, 0.5f, 0.1f); }, 1},
                          {"sun", SkyWithSun, 8, false, 400},
                          {"compensated sun", SkyWithSun, 8, true, 400}};
    const Transform transforms[] = {Transform(), Transform::Rotate(70, {1, -2, 1}), Transform::Scale({1, -1, 1}),
                                    Transform::Scale({2, 1, 1.5f})};
    for (const Case &c : cases)
        for (const Transform &ctm : transforms) {
            SCOPED_TRACE(c.name);
            Params params;
            std::optional<TemporaryImage> file;
            if (c.color) {
                file.emplace("grid.exr", RgbImage(Point2i(c.resolution), c.color));
                params = FileParams(*file);
            }
            auto light = Make("infinite", params, ctm);
            light->Preprocess({0, 0, 0}, 2);
            const auto pdf = [&](const Vector3 &w) { return light->PdfLi(At({0, 0, 0}), w, {}, {}, c.isCompensated); };
            int elsewhere = 0;  // rounding carries directions over borders of pixels
            double mass;
            const double p = DirectionTest(
                [&](Rng &rng) -> std::optional<Vector3> {
                    const auto s = light->SampleLi(At({0, 0, 0}), rng.Uniform2(), kLambda, c.isCompensated);
                    if (!s) return {};
                    const Float L = light->Le({}, s->wi, kLambda).Average();
                    elsewhere +=
                        !(std::abs(pdf(s->wi) / s->pdf - 1) < 1e-3f) || !(std::abs(L / s->L.Average() - 1) < 1e-3f);
                    return s->wi;
                },
                pdf, c.fine ? 60000 : 20000, 24, &mass, c.fine);
            EXPECT_LE(elsewhere, 5);
            EXPECT_NEAR(mass, 1, c.fine ? 2e-3 : 5e-3);
            EXPECT_GT(p, SidakAlpha(1e-4, std::size(cases) * std::size(transforms)));
        }
}

class ImageInfinite : public testing::Test {
  protected:
    ImageInfinite() : file_("sky.exr", RgbImage({8, 8}, SkyWithSun)) {}
    std::unique_ptr<Light> MakeIt(const Transform &ctm) {
        auto light = Make("infinite", FileParams(file_).Number("scale", 0.8f), ctm);
        light->Preprocess({0, 0, 0}, 2);
        return light;
    }
    TemporaryImage file_;
};

TEST_F(ImageInfinite, CompensatedDensitySkipsWhatIsBelowAverage) {
    auto light = MakeIt(Transform());
    int positive = 0;
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x) {
            const Vector3 w = EqualAreaSquareToSphere(PixelCenter(x, y, {8, 8}));
            EXPECT_GT(light->PdfLi(At({0, 0, 0}), w, {}, {}, false), 0);
            positive += light->PdfLi(At({0, 0, 0}), w, {}, {}, true) > 0;
        }
    EXPECT_EQ(positive, 1) << "the sun";
}

TEST_F(ImageInfinite, ImageIsTurnedByTheTransform) {
    Vector3 sun = EqualAreaSquareToSphere({3.5f / 8, 5.5f / 8});
    auto straight = MakeIt(Transform());
    Transform turn = Transform::Rotate(65, {1, 0, 2});
    auto turned = MakeIt(turn);
    EXPECT_GT(straight->Le({}, sun, kLambda).Average(), 20 * straight->Le({}, -sun, kLambda).Average());
    EXPECT_NEAR(turned->Le({}, turn.Vector(sun), kLambda).Average() / straight->Le({}, sun, kLambda).Average(), 1,
                1e-5);
}

TEST(GreyInfinite, IsSampledUniformlyAndItsIlluminanceHasStocksFactorOfTwo) {
    TemporaryImage grey("grey.exr", RgbImage({64, 64}, [](int, int) { return Rgb(0.5f); }));
    auto light = Make("infinite", FileParams(grey));
    light->Preprocess({0, 0, 0}, 1);
    EXPECT_NEAR(light->PdfLi(At({0, 0, 0}), {0, 0.6f, 0.8f}, {}, {}, true), UniformSpherePdf(), 1e-6);
    EXPECT_NEAR(Nits(*light, {0, 0.6f, 0.8f}), 0.5, 2e-3);
    // Measured over the upper hemisphere.
    EXPECT_NEAR(Nits(*Make("infinite", FileParams(grey).Number("illuminance", 3))) * std::numbers::pi, 2 * 3, 0.02);
}

}  // namespace
}  // namespace pbrt::test
