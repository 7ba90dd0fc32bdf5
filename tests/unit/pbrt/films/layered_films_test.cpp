#include <gtest/gtest.h>

#include <set>

#include "film_fixtures.h"

namespace pbrt::test {
namespace {

constexpr int kSamples = 4000;
Float Step(int i) { return (Float(i) + Float(0.5)) / kSamples; }

TEST(SpectralFilm, BucketsHoldTheMeanRadianceWithinThem) {
    auto film = MakeFullFloat("spectral",
                              FilmSize(2, 1).Number("lambdamin", 400).Number("lambdamax", 700).Integer("nbuckets", 10));
    // The mean of a linear spectrum over a bucket is its value at the centre.
    const PiecewiseLinearSpectrum line({300, 900}, {1, 7});
    for (int i = 0; i < kSamples; ++i) {
        const SampledWavelengths lambda = film->SampleWavelengths(Step(i));
        film->AddSample({{1, 0}, line.Sample(lambda) / CieYIntegral, lambda, Float(0.5) + Step(i), {}});
    }
    const ImageMetadata m = film->Metadata();
    EXPECT_EQ(std::get<std::string>(m.attributes.at("spectralLayoutVersion")), "1.0");
    EXPECT_EQ(std::get<std::string>(m.attributes.at("emissiveUnits")), "W.m^-2.sr^-1");
    const Image image = film->ToImage();
    ASSERT_EQ(image.ChannelCount(), 13);
    EXPECT_EQ(image.Channels()[3], "S0.415,000nm");
    EXPECT_EQ(image.Channels()[12], "S0.685,000nm");
    for (int b = 0; b < 10; ++b) {
        EXPECT_NEAR(image.Get({1, 0}, 3 + b), line(415 + 30 * Float(b)), 0.01f);
        EXPECT_EQ(image.Get({0, 0}, 3 + b), 0.0f);
    }
}

TEST(SpectralFilm, OverTheWholeRangeRgbIsThatOfTheRgbFilm) {
    auto film = MakeFullFloat("spectral", FilmSize(2, 1)), plain = MakeFullFloat("rgb", FilmSize(2, 1));
    EXPECT_EQ(film->ToImage().ChannelCount(), 3 + 16);
    const RgbIlluminantSpectrum color(ColorSpace::SRGB(), {0.8f, 0.4f, 0.2f});
    for (int i = 0; i < kSamples; ++i) {
        SampledWavelengths lambda = film->SampleWavelengths(Step(i));
        film->AddSample({{0, 0}, color.Sample(lambda), lambda, 1, {}});
        lambda = plain->SampleWavelengths(Step(i));
        plain->AddSample({{0, 0}, color.Sample(lambda), lambda, 1, {}});
    }
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(film->ToImage().Get({0, 0}, c) / plain->ToImage().Get({0, 0}, c), 1, 5e-3);
}

TEST(SpectralFilm, WavelengthsThatEndedDoNotCount) {
    auto film = MakeFullFloat("spectral", FilmSize(2, 1).Integer("nbuckets", 4));
    // Half of the paths terminate three of their wavelengths, whose radiance is then meaningless.
    for (int i = 0; i < kSamples; ++i) {
        SampledWavelengths lambda = film->SampleWavelengths(Step(i));
        SampledSpectrum L(i % 2 ? 1 : 3);
        if (i % 2) {
            lambda.TerminateSecondary();
            for (int k = 1; k < SpectrumSamples; ++k) L[k] = 1000;
        }
        film->AddSample({{0, 0}, L / CieYIntegral, lambda, 1, {}});
    }
    for (int b = 0; b < 4; ++b) EXPECT_NEAR(film->ToImage().Get({0, 0}, 3 + b), 2, 0.02);
}

TEST(SpectralFilm, BadRangesAreErrors) {
    EXPECT_THROW(MakeFullFloat("spectral", FilmSize(2, 1).Number("lambdamin", 300)), UserError);
    EXPECT_THROW(MakeFullFloat("spectral", FilmSize(2, 1).Number("lambdamax", 900)), UserError);
    EXPECT_THROW(MakeFullFloat("spectral", FilmSize(2, 1).Number("lambdamin", 600).Number("lambdamax", 600)),
                 UserError);
    EXPECT_THROW(MakeFullFloat("spectral", FilmSize(2, 1).Integer("nbuckets", -1)), UserError);
    // The names of the channels have three decimals.
    const auto narrow = [](int n) {
        return FilmSize(2, 1).Number("lambdamin", 500).Number("lambdamax", 500.5f).Integer("nbuckets", n);
    };
    EXPECT_THROW(MakeFullFloat("spectral", narrow(600)), UserError);
    const std::vector<std::string> names = MakeFullFloat("spectral", narrow(200))->ToImage().Channels();
    EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), 203u);
}

TEST(LayeredFilms, OnlyFitIntoExr) {
    for (const char *type : {"gbuffer", "spectral"}) {
        EXPECT_THROW(MakeFullFloat(type, FilmSize(2, 1).String("filename", "a.png")), UserError) << type;
        EXPECT_NO_THROW(MakeFullFloat(type, FilmSize(2, 1).String("filename", "a.exr"))) << type;
    }
    EXPECT_THROW(MakeFullFloat("gbufer", FilmSize(2, 1)), UserError);
}

TEST(GBufferFilm, HoldsMeansOverTheSamplesThatHitASurface) {
    auto film = MakeFullFloat("gbuffer", FilmSize(2, 1));
    VisibleSurface a, b;
    a.p = {1, 2, 3};
    b.p = {3, 0, 7};
    a.n = a.ns = {1, 0, 0};
    b.n = b.ns = {0, 1, 0};
    a.uv = {0.2f, 0.4f};
    b.uv = {0.6f, 0.8f};
    a.dpdx = {7, 5, -2};
    b.dpdy = {1, 1, 4};
    for (int i = 0; i < kSamples; ++i) {
        const SampledWavelengths lambda = film->SampleWavelengths(Step(i));
        a.lambda = b.lambda = lambda;
        a.albedo = b.albedo = SampledSpectrum(0.6f);
        const SampledSpectrum L = ColorSpace::SRGB().Illuminant().Sample(lambda) / CieYIntegral;
        film->AddSample({{0, 0}, L, lambda, 1, a});
        film->AddSample({{0, 0}, L, lambda, 3, b});
        film->AddSample({{0, 0}, L, lambda, 4, {}});
        film->AddSample({{0, 0}, SampledSpectrum(0), lambda, 8, {}, false});
        film->AddSample({{1, 0}, L, lambda, 1, {}});
    }
    const Image image = film->ToImage();
    auto value = [&](const char *channel, int x = 0) {
        const int c = image.FindChannel(channel);
        EXPECT_GE(c, 0) << channel;
        return image.Get({x, 0}, c);
    };
    EXPECT_NEAR(value("P.X"), 2.5f, 1e-4f);
    EXPECT_NEAR(value("P.Y"), 0.5f, 1e-4f);
    EXPECT_NEAR(value("P.Z"), 6, 1e-4f);
    EXPECT_NEAR(value("u"), 0.5f, 1e-4f);
    EXPECT_NEAR(value("v"), 0.7f, 1e-4f);
    EXPECT_NEAR(value("dzdx"), 0.5f, 1e-4f);
    EXPECT_NEAR(value("dzdy"), 3, 1e-4f);
    EXPECT_NEAR(value("N.X"), 1 / std::sqrt(10.0f), 1e-4f);
    EXPECT_NEAR(value("Ns.Y"), 3 / std::sqrt(10.0f), 1e-4f);
    for (const char *channel : {"Albedo.R", "Albedo.G", "Albedo.B"})
        EXPECT_NEAR(value(channel), 0.3f, 2e-3f);  // half of the weight of rays belongs to those that see nothing
    for (const std::string &channel : image.Channels())
        if (channel != "R" && channel != "G" && channel != "B") {
            EXPECT_EQ(value(channel.c_str(), 1), 0) << channel;
        }
}

TEST(GBufferFilm, VarianceIsThatOfTheSamplesThatHitASurface) {
    auto film = MakeFullFloat("gbuffer", FilmSize(2, 1));
    const SampledWavelengths lambda = film->SampleWavelengths(0.3f);
    const Vector3 unit((CieX().Sample(lambda) / lambda.Pdf()).Average(),
                       (CieY().Sample(lambda) / lambda.Pdf()).Average(),
                       (CieZ().Sample(lambda) / lambda.Pdf()).Average());
    VisibleSurface surface;
    surface.lambda = lambda;
    for (Float L : {1.0f, 2.0f, 6.0f}) film->AddSample({{0, 0}, SampledSpectrum(L), lambda, 1, surface});
    film->AddSample({{0, 0}, SampledSpectrum(50), lambda, 1, {}});
    const Image image = film->ToImage();
    // The values 1, 2 and 6 have mean 3 and variance 7.
    const char *channels[3] = {"R", "G", "B"};
    for (int c = 0; c < 3; ++c) {
        const Float variance = image.Get({0, 0}, image.FindChannel(std::string("Variance.") + channels[c]));
        const Float relative = image.Get({0, 0}, image.FindChannel(std::string("RelativeVariance.") + channels[c]));
        EXPECT_NEAR(variance / (7 * Sqr(unit[c])), 1, 1e-4f);
        EXPECT_NEAR(relative / (7.0f / 3 * unit[c]), 1, 1e-4f);
    }
}

TEST(GBufferFilm, PlacesAreInTheChosenCoordinates) {
    // The camera moves from x = 0 to x = 8 and looks along +x; world space is rendering space moved up by 100.
    const Transform turn = Transform::Rotate(90, {0, 1, 0});
    const AnimatedTransform camera(turn, 0, Transform::Translate({8, 0, 0}) * turn, 1);
    const Transform world = Transform::Translate({0, 100, 0});
    VisibleSurface surface;
    surface.p = {5, 0, 0};
    surface.n = surface.ns = {-1, 0, 0};
    surface.dpdx = {-3, 0, 0};
    surface.dpdy = {0, 0, 2};
    surface.time = 0.25f;
    surface.lambda = SampledWavelengths::SampleVisible(0.5f);
    auto pixel = [&](const char *system, const std::vector<const char *> &channels) {
        auto film =
            MakeFullFloat("gbuffer", FilmSize(2, 1).String("coordinatesystem", system),
                          {.outputSpace = ColorSpace::SRGB(), .renderFromCamera = camera, .renderFromWorld = world});
        film->AddSample({{0, 0}, SampledSpectrum(1), surface.lambda, 1, surface});
        const Image image = film->ToImage();
        std::vector<Float> values;
        for (const char *c : channels)
            values.push_back(std::round(image.Get({0, 0}, image.FindChannel(c)) * 1e4f) / 1e4f);
        return values;
    };
    const std::vector<const char *> channels = {"P.X", "P.Y", "P.Z", "N.X", "N.Y", "N.Z", "dzdx", "dzdy"};
    EXPECT_EQ(pixel("camera", channels), (std::vector<Float>{0, 0, 3, 0, 0, -1, 3, 0}));
    EXPECT_EQ(pixel("world", channels), (std::vector<Float>{5, -100, 0, -1, 0, 0, 0, 2}));
    EXPECT_THROW(MakeFullFloat("gbuffer", FilmSize(2, 1).String("coordinatesystem", "render")), UserError);
}

}  // namespace
}  // namespace pbrt::test
