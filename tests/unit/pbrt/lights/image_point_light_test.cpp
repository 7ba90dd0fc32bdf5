// Point lights that project an image: goniometric and projection.
#include "light_test_support.h"
#include "pbrt/lights/point_lights.h"

namespace pbrt::test {
namespace {

/// The intensity along w (rendering space, unit length) of a light at p, averaged over the wavelengths.
double IntensityAlong(const Light &light, const Point3 &p, const Vector3 &w) {
    auto s = light.SampleLi(At(p + w), {}, kLambda, false);
    return s ? double(s->L.Average()) : 0;
}

class Goniometric : public testing::Test {
  protected:
    Goniometric()
        : file_("lobes.exr",
                GreyImage(8, [](int x, int y) { return 0.1f * Float(x + 2 * y) + (x == 2 ? 3.f : 0.f); })) {}
    TemporaryImage file_;
};

TEST_F(Goniometric, PowerParameterIsTheFlux) {
    auto light = Make("goniometric", FileParams(file_).Number("power", 12).Floats(ParamType::Blackbody, "I", {3000}));
    EXPECT_NEAR(Lumens(*light), 12, 0.05);
}

TEST_F(Goniometric, ImageIsIndexedByDirectionWithYAndZSwapped) {
    Transform ctm = Transform::Translate({1, 2, 3}) * Transform::Rotate(35, {3, 1, 2}) * Transform::Scale(Vector3(2));
    auto light = Make("goniometric", FileParams(file_), ctm);
    auto one = Make("point", Params(), ctm);
    Rng rng(1);
    for (int i = 0; i < 200; ++i) {
        const int x = int(rng.UniformInt(8)), y = int(rng.UniformInt(8));
        Vector3 inImage = EqualAreaSquareToSphere(PixelCenter(x, y, {8, 8}));
        Vector3 w = Normalize(ctm.Vector({inImage.x, inImage.z, inImage.y}));
        double expected = 0.1 * (x + 2 * y) + (x == 2 ? 3 : 0);
        EXPECT_NEAR(IntensityAlong(*light, {1, 2, 3}, w) / IntensityAlong(*one, {1, 2, 3}, w), expected,
                    2e-3 * expected + 1e-6);
    }
}

TEST_F(Goniometric, RgbImagesCountByTheirMeanAndNegativeValuesAsNothing) {
    TemporaryImage rgb("three.exr", RgbImage({4, 4}, [](int, int) { return Rgb(0.3f, 0.6f, 1.8f); }));
    EXPECT_NEAR(Lux(*Make("goniometric", FileParams(rgb)), {0, 0.6f, 0.8f}) / Lux(*Make("point", Params()), {0, 0, 1}),
                0.9, 1e-3);
    TemporaryImage negative("negative.exr", GreyImage(2, [](int, int) { return -1.f; }));
    auto dark = Make("goniometric", FileParams(negative));
    EXPECT_FALSE(dark->SampleLi(At({1, 0, 0}), {}, kLambda, false));
    EXPECT_FALSE(dark->Bounds());
}

TEST_F(Goniometric, WithoutAnImageItIsAPointLightWithAWarning) {
    DiagnosticSink sink;
    auto light = Make("goniometric", Params().Number("power", 7), {}, {}, sink);
    EXPECT_EQ(sink.All().size(), 1u);
    EXPECT_FALSE(sink.HasErrors());
    EXPECT_NEAR(Lumens(*light), 7, 0.02);
}

class Projection : public testing::TestWithParam<Point2i> {
  protected:
    Projection() : file_("slide.exr", RgbImage(GetParam(), Slide)) {}
    static Rgb Slide(int x, int y) { return {0.2f + 0.05f * Float(x), 0.3f, 0.1f + 0.02f * Float(y)}; }
    TemporaryImage file_;
};

TEST_P(Projection, PhiIsTheIntegralOfIntensity) {
    for (Float fov : {20.f, 90.f, 130.f}) {
        auto light = Make("projection", FileParams(file_).Number("fov", fov).Number("scale", 2),
                          Transform::Rotate(50, {1, 2, 3}));
        constexpr int kSide = 600;
        double mean = 0;
        for (int i = 0; i < kSide * kSide; ++i) {
            const Point2 u = PixelCenter(i % kSide, i / kSide, {kSide, kSide});
            mean += IntensityAlong(*light, Point3(0), SampleUniformSphere(u)) / (kSide * kSide);
        }
        EXPECT_NEAR(mean * 4 * std::numbers::pi / light->Phi(kLambda).Average(), 1, 1.5e-2) << fov;
    }
}

TEST_P(Projection, PowerParameterIsTheFlux) {
    auto light = Make("projection", FileParams(file_).Number("power", 9).Number("fov", 40));
    EXPECT_NEAR(Lumens(*light, 500), 9, 0.1);
}

TEST_P(Projection, TopIsUpRightIsRightAndTheShorterSideHasTheFov) {
    Point2i n = GetParam();
    auto light = Make("projection", FileParams(file_).Number("fov", 60));
    Float t = std::tan(Radians(30)), aspect = Float(n.x) / Float(n.y);
    Float hx = t * std::max(aspect, Float(1)), hy = t * std::max(1 / aspect, Float(1));
    for (int y = 0; y < n.y; ++y)
        for (int x = 0; x < n.x; ++x) {
            const Point2 u = PixelCenter(x, y, n);
            Vector3 w = Normalize(Vector3((2 * u.x - 1) * hx, (1 - 2 * u.y) * hy, 1));
            auto s = light->SampleLi(At(w), {}, kLambda, false);
            ASSERT_TRUE(s);
            SampledSpectrum expected = RgbIlluminantSpectrum(ColorSpace::SRGB(), Slide(x, y)).Sample(kLambda) /
                                       SpectrumToPhotometric(ColorSpace::SRGB().Illuminant());
            EXPECT_NEAR(s->L.Average() / expected.Average(), 1, 1e-3) << x << " " << y;
        }
    const auto reaches = [&](const Point3 &at) { return light->SampleLi(At(at), {}, kLambda, false).has_value(); };
    for (Float side : {-1.f, 1.f})
        for (Float part : {0.999f, 1.001f}) {
            EXPECT_EQ(reaches({side * hx * part, 0, 1}), part < 1);
            EXPECT_EQ(reaches({0, side * hy * part, 1}), part < 1);
        }
    EXPECT_FALSE(reaches({0, 0, -1})) << "a projection light sends no light backwards";
}

INSTANTIATE_TEST_SUITE_P(Formats, Projection, testing::Values(Point2i(48, 32), Point2i(40, 40), Point2i(27, 45)),
                         [](const auto &c) { return std::to_string(c.param.x) + "x" + std::to_string(c.param.y); });

TEST(ImageLightImportance, PositiveWhereTheyContribute) {
    Rng rng(1);
    TemporaryImage slide("dots.exr",
                         RgbImage({5, 3}, [](int x, int y) { return (x + y) % 2 ? Rgb(1, 0.5f, 0) : Rgb(0); }));
    TemporaryImage lobes("dots1.exr", GreyImage(4, [](int x, int y) { return (x + y) % 2 ? 1.f : 0.f; }));
    int lit = 0;
    for (int i = 0; i < 60; ++i) {
        const Transform ctm = RandomPlace(rng, i);
        auto light = i % 3 ? Make("projection", FileParams(slide).Number("fov", 1 + 175 * rng.Uniform()), ctm)
                           : Make("goniometric", FileParams(lobes), ctm);
        LightBounds bounds = *light->Bounds();
        for (int j = 0; j < 4000; ++j) {
            // Half of the points are near the axis.
            Vector3 d = SampleUniformSphere(rng.Uniform2());
            if (j % 2) d = Normalize(bounds.w + d * rng.Uniform());
            Point3 p = bounds.bounds.low + d * (10 * rng.Uniform());
            lit += ExpectImportantIfLit(*light, bounds, p, rng);
        }
    }
    EXPECT_GT(lit, 10000);
}

}  // namespace
}  // namespace pbrt::test
