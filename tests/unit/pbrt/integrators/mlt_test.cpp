// Metropolis light transport makes the picture that paths from the camera make, whatever its parameters.
#include "pbrt/integrators/mlt_integrator.h"
#include "support/errors.h"
#include "support/light_views.h"

namespace pbrt::test {
namespace {

TEST(PrimarySampler, ReturnsTheListAndDrawsFurtherNumbers) {
    Rng rng(1), same(1);
    std::vector<Float> numbers(100);
    for (size_t i = 0; i < numbers.size(); ++i) numbers[i] = Float(i) / 200;
    const std::vector<Float> given = numbers;
    PrimarySampler sampler(numbers, rng);
    sampler.StartPixelSample({0, 0}, 0);
    std::vector<Float> got;
    while (got.size() < 130) {
        const Float one = sampler.Get1D();
        const Point2 two = sampler.Get2D(), next = sampler.Get2D();
        got.insert(got.end(), {one, two.x, two.y, next.x, next.y});
    }
    ASSERT_GE(numbers.size(), got.size());
    for (size_t i = 0; i < got.size(); ++i) EXPECT_EQ(got[i], i < given.size() ? given[i] : same.Uniform()) << i;

    PrimarySampler again(numbers, rng);
    again.StartPixelSample({0, 0}, 0);
    for (int i = 0; i < 20; ++i) EXPECT_EQ(again.Get1D(), got[i]);
    again.DropUnused();
    EXPECT_GE(numbers.size(), 20u);
    EXPECT_LT(numbers.size(), 40u);
}

TEST(PrimarySampler, StepsAreNormalAndKeepNumbersEven) {
    Rng rng(2);
    constexpr int kCount = 200000;
    constexpr Float kSigma = 0.03f;
    std::vector<Float> from(kCount), to;
    for (Float &v : from) v = rng.Uniform();
    PerturbNumbers(from, kSigma, rng, to);
    ASSERT_EQ(to.size(), from.size());
    double first = 0, second = 0, fourth = 0, product = 0, last = 0;
    std::vector<int> cells(20);
    for (size_t i = 0; i < to.size(); ++i) {
        ASSERT_GE(to[i], 0);
        ASSERT_LT(to[i], 1);
        ++cells[size_t(to[i] * 20)];
        double step = double(to[i] - from[i]);
        step = (step - std::round(step)) / double(kSigma);
        first += step / kCount;
        second += step * step / kCount;
        fourth += step * step * step * step / kCount;
        product += step * last / kCount;
        last = step;
    }
    EXPECT_NEAR(first, 0, 5 / std::sqrt(kCount));
    EXPECT_NEAR(second, 1, 5 * std::sqrt(2.0 / kCount));
    EXPECT_NEAR(fourth, 3, 5 * std::sqrt(96.0 / kCount));
    EXPECT_NEAR(product, 0, 5 / std::sqrt(kCount));
    for (int n : cells) EXPECT_NEAR(n, kCount / 20, 5 * std::sqrt(kCount / 20));
}

/// Few renders of many samples, as chains of few find strong contributions in dark tiles too rarely.
void SetRenders(View &view) {
    view.samples = 160;
    view.renders = 9;
}

class MltViews : public testing::TestWithParam<View> {};

TEST_P(MltViews, AgreeWithPath) {
    View view = GetParam();
    SetRenders(view);
    view.parameters = "'integer bootstrapsamples' 10000 'integer chains' 640";
    CheckMean(view, "mlt", 0.44);
}

/// What differs for primary samples: the part of the film plane and the filter, how many numbers a path takes,
/// wavelengths that end, and light that few pairs find.
INSTANTIATE_TEST_SUITE_P(All, MltViews,
                         testing::ValuesIn(ViewsNamed({"DiskAndBall", "Lens", "SphericalEqualArea", "Crop",
                                                       "PointSpotAndDistant", "Coat", "SmoothGlass", "SkyAndGlass",
                                                       "DenseAndColored", "Grid", "CameraInside", "Dispersion",
                                                       "Glow"})),
                         testing::PrintToStringParamName());

/// Single small bootstraps estimate the brightness badly; their mean is exact for every choice of parameters.
TEST(Mlt, ParametersDoNotChangeTheMean) {
    View view = AllViews()[0];
    SetRenders(view);
    for (const char *parameters :
         {"'integer bootstrapsamples' 1 'integer chains' 1 'float sigma' .05",
          "'integer bootstrapsamples' 1 'integer chains' 9999 'float largestepprobability' 0",
          "'integer bootstrapsamples' 1 'integer chains' 500 'float largestepprobability' 1"}) {
        view.parameters = parameters;
        CheckMean(view, "mlt", 0.55);
    }
}

TEST(Mlt, IsTheSameForAnyNumberOfThreads) {
    for (View view : {AllViews()[0], FoggyViews()[2]}) {
        view.parameters = "'integer bootstrapsamples' 10000";
        CheckThreads(view, "mlt", 12);
    }
}

/// Vertices are connected to the lights that any sampler chooses, which is as before its first sample for all chains.
TEST(Mlt, LightSamplersDoNotChangeTheMean) {
    View view = AllViews()[0];
    SetRenders(view);
    view.parameters = "'integer bootstrapsamples' 20000";
    CheckLightSamplers(view, "mlt");
}

TEST(Mlt, UnsupportedFilmsAndCamerasThrow) {
    View view = AllViews()[0];
    const auto render = [&] { RenderView(view, "mlt", 1, 1); };
    view.camera = kRealisticCamera;
    ExpectError(render, {"perspective", "orthographic", "spherical"});
    view = AllViews()[0];
    view.filmType = "gbuffer";
    ExpectError(render, {"rgb", "spectral"});
}

TEST(Mlt, WithoutLightIsBlack) {
    View view = AllViews()[0];
    view.objects = "";
    const Image image = RenderView(view, "mlt", 1, 2);
    for (int x = 0; x < kViewSize; ++x) EXPECT_EQ(image.Get({x, 12}, 0), 0);
}

}  // namespace
}  // namespace pbrt::test
