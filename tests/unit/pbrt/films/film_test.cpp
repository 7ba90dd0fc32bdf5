#include "film_fixtures.h"
#include "pbrt/films/sensor.h"
#include "support/errors.h"

namespace pbrt::test {
namespace {

class FilmTest : public ::testing::Test {
  protected:
    void Resolution(int x, int y) { params_.Integer("xresolution", x).Integer("yresolution", y); }
    FilmContext Context(Float exposure = 1, const ColorSpace &space = ColorSpace::SRGB()) const {
        return {space, exposure, overrides_, {}, {}};
    }
    std::unique_ptr<Film> Make(Float exposure = 1, const ColorSpace &space = ColorSpace::SRGB()) {
        return MakeFilm("rgb", params_, Context(exposure, space), sink_);
    }
    /// Adds many samples of an emission spectrum, divided by its photometric integral, to one pixel; returns the colour
    /// of the pixel.
    static Rgb Expose(Film &film, const Spectrum &emission, Float scale = 1, int n = 40000) {
        Float photometric = SpectrumToPhotometric(emission);
        for (int i = 0; i < n; ++i) {
            SampledWavelengths lambda = film.SampleWavelengths((Float(i) + Float(0.5)) / Float(n));
            film.AddSample({film.PixelBounds().low, scale / photometric * emission.Sample(lambda), lambda, 1, {}});
        }
        return ColorAt(film);
    }

    Params params_{"Film \"rgb\""};
    FilmOverrides overrides_;
    DiagnosticSink sink_;
};

TEST_F(FilmTest, Defaults) {
    std::unique_ptr<Film> film = Make();
    EXPECT_EQ(film->FullResolution(), Point2i(1280, 720));
    EXPECT_EQ(film->Filename(), "pbrt.exr");
    EXPECT_EQ(film->DiagonalMm(), 35.0f);
    EXPECT_EQ(film->PixelBounds().high, Point2i(1280, 720));
    EXPECT_FALSE(sink_.HasErrors());
}

TEST_F(FilmTest, FlagsOverrideThePixelsOfTheScene) {
    struct Case {
        const char *name;
        Point2i resolution;
        std::vector<int> pixelBounds;
        std::vector<Float> cropWindow;
        FilmOverrides overrides;
        Bounds2i expected;
        size_t warnings;
    };
    FilmOverrides bounds, quick;
    bounds.pixelBounds = Bounds2i{{1, 2}, {3, 4}};
    FilmOverrides crop = bounds;
    crop.cropWindow = Bounds2{{0, 0}, {0.1f, 0.2f}};
    quick.resolutionDivisor = 4;
    // The first window is that stored in stock pbrt-v4's picture of film/crop_and_maxcomponent.
    const Case kCases[] = {
        {"crop window, rounded up", {128, 96}, {}, {0.125f, 0.8125f, 0.25f, 0.91667f}, {}, {{16, 24}, {104, 89}}, 0},
        {"half-open bounds", {128, 96}, {24, 104, 24, 88}, {}, {}, {{24, 24}, {104, 88}}, 0},
        {"bounds from the far corner", {128, 96}, {104, 24, 88, 24}, {}, {}, {{24, 24}, {104, 88}}, 0},
        {"both", {100, 100}, {24, 30, 24, 30}, {0.5f, 1, 0, 0.25f}, {}, {{50, 0}, {100, 25}}, 1},
        {"bounds by flag", {100, 100}, {}, {0.5f, 1, 0, 0.25f}, bounds, {{1, 2}, {3, 4}}, 0},
        {"crop window by flag", {100, 100}, {}, {0.5f, 1, 0, 0.25f}, crop, {{0, 0}, {10, 20}}, 0},
        {"beyond the picture", {10, 10}, {-5, 5, 5, 50}, {}, {}, {{0, 5}, {5, 10}}, 1},
        {"crop window beyond the picture", {10, 10}, {}, {0.5f, 2, -9, 1}, {}, {{5, 0}, {10, 10}}, 1},
        {"quick", {128, 98}, {24, 104, 24, 90}, {}, quick, {{6, 6}, {26, 23}}, 0},
        {"all, quick", {8, 12}, {0, 2147483647, 0, 2147483647}, {}, quick, {{0, 0}, {2, 3}}, 1}};
    for (const Case &c : kCases) {
        SCOPED_TRACE(c.name);
        params_ = FilmSize(c.resolution.x, c.resolution.y);
        sink_ = {};
        if (!c.pixelBounds.empty()) params_.Integers("pixelbounds", c.pixelBounds);
        if (!c.cropWindow.empty()) params_.Floats(ParamType::Float, "cropwindow", c.cropWindow);
        overrides_ = c.overrides;
        const std::unique_ptr<Film> film = Make();
        EXPECT_EQ(film->PixelBounds().low, c.expected.low);
        EXPECT_EQ(film->PixelBounds().high, c.expected.high);
        EXPECT_EQ(film->FullResolution(), c.resolution / c.overrides.resolutionDivisor);
        EXPECT_EQ(film->Metadata().fullResolution, film->FullResolution());
        EXPECT_EQ(film->Metadata().pixelBounds->low, c.expected.low);
        EXPECT_EQ(sink_.All().size(), c.warnings);
        EXPECT_FALSE(sink_.HasErrors());
    }
}

TEST_F(FilmTest, BadParametersAreErrors) {
    Resolution(10, 10);
    const std::pair<const char *, std::vector<Float>> kBad[] = {{"cropwindow", {0, 1, 0}},
                                                                {"cropwindow", {0.5f, 0.5f, 0, 1}},
                                                                {"iso", {0}},
                                                                {"whitebalance", {-1}},
                                                                {"whitebalance", {1e-37f}},
                                                                {"whitebalance", {999}},
                                                                {"maxcomponentvalue", {0}},
                                                                {"diagonal", {0}}};
    for (const auto &[name, values] : kBad) {
        const Params good = params_;
        params_.Floats(ParamType::Float, name, values);
        EXPECT_THROW(Make(), UserError) << name;
        params_ = good;
    }
    EXPECT_NO_THROW(Make());
    params_.Integer("xresolution", 0);
    EXPECT_THROW(Make(), UserError);
}

TEST_F(FilmTest, UnknownSensorsListTheChoices) {
    Resolution(1, 1);
    for (const std::string &name : SupportedSensors()) {
        params_.String("sensor", name);
        EXPECT_NO_THROW(Make()) << name;
    }
    EXPECT_EQ(SupportedSensors().size(), 18u);
    params_.String("sensor", "nikon_d851");
    ExpectError([&] { Make(); }, {"nikon_d850"});
}

TEST_F(FilmTest, UnwritableFileNamesAreErrorsAtOnce) {
    Resolution(1, 1);
    for (const char *name : {"a.png", "b.EXR", "dir.x/c.pfm"}) {
        overrides_.filename = name;
        EXPECT_EQ(Make()->Filename(), name);
    }
    overrides_.filename.clear();
    for (const char *name : {"a.jpg", "b", ""}) {
        params_.String("filename", name);
        EXPECT_THROW(Make(), UserError) << name;
    }
}

TEST_F(FilmTest, NormalisedIlluminantGivesWhiteOfLuminanceOne) {
    Resolution(1, 1);
    params_.Number("maxcomponentvalue", 1e9f);
    for (const std::string &name : ColorSpace::Names()) {
        const ColorSpace &space = *ColorSpace::Find(name);
        std::unique_ptr<Film> film = Make(1, space);
        Rgb rgb = Expose(*film, space.Illuminant());
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(rgb[c], 1, 2e-3) << name;
    }
}

TEST_F(FilmTest, RgbEmissionComesOutAsWritten) {
    Resolution(1, 1);
    std::unique_ptr<Film> film = Make();
    Rgb rgb = Expose(*film, RgbIlluminantSpectrum(ColorSpace::SRGB(), {3.4f, 2.4f, 1.2f}));
    EXPECT_NEAR(rgb.x, 3.4f, 1e-2);
    EXPECT_NEAR(rgb.y, 2.4f, 1e-2);
    EXPECT_NEAR(rgb.z, 1.2f, 1e-2);
}

TEST_F(FilmTest, IsoAndExposureScale) {
    Resolution(1, 1);
    params_.Number("iso", 180);
    std::unique_ptr<Film> film = Make(0.5f);
    EXPECT_NEAR(Expose(*film, ColorSpace::SRGB().Illuminant()).y, 0.9f, 2e-3);
}

TEST_F(FilmTest, WhiteBalanceMakesItsIlluminantWhite) {
    Resolution(1, 1);
    params_.Number("whitebalance", 5000);
    std::unique_ptr<Film> film = Make();
    Rgb rgb = Expose(*film, DaylightSpectrum(5000));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(rgb[c], 1, 3e-3);
}

TEST_F(FilmTest, WeightedMean) {
    Resolution(2, 1);
    std::unique_ptr<Film> film = Make();
    SampledWavelengths lambda = film->SampleWavelengths(0.4f);
    SampledSpectrum L = lambda.Pdf();
    film->AddSample({{1, 0}, L * 1.0f, lambda, 1, {}});
    Float one = film->ToImage().Get({1, 0}, 1);
    film->AddSample({{1, 0}, L * 5.0f, lambda, 3, {}});
    film->AddSample({{1, 0}, L * 2.0f, lambda, -1, {}});
    EXPECT_NEAR(film->ToImage().Get({1, 0}, 1) / one, (1 + 15 - 2) / 3.0f, 5e-3);
    EXPECT_EQ(film->ToImage().Get({0, 0}, 1), 0.0f);
}

TEST_F(FilmTest, MaxComponentScalesTheSampleDown) {
    Resolution(1, 1);
    params_.Number("maxcomponentvalue", 2);
    std::unique_ptr<Film> limited = Make();
    const std::unique_ptr<Film> unlimited = MakeFilm("rgb", Params(), {.outputSpace = ColorSpace::SRGB()}, sink_);
    SampledWavelengths lambda = limited->SampleWavelengths(0.4f);
    SampledSpectrum L = lambda.Pdf() * 100.0f;
    limited->AddSample({{0, 0}, L, lambda, 1, {}});
    unlimited->AddSample({{0, 0}, L, lambda, 1, {}});
    const Xyz a = ColorSpace::SRGB().ToXyz(ColorAt(*limited)), b = ColorSpace::SRGB().ToXyz(ColorAt(*unlimited));
    EXPECT_NEAR(MaxComponent(a), 2, 5e-3);
    EXPECT_GT(MaxComponent(b), 2.0f);
    EXPECT_NEAR(a.x / a.y, b.x / b.y, 5e-3);
}

TEST_F(FilmTest, NotFiniteSamplesAreDroppedAndCounted) {
    Resolution(1, 1);
    std::unique_ptr<Film> film = Make();
    SampledWavelengths lambda = film->SampleWavelengths(0.4f);
    SampledSpectrum good = lambda.Pdf(), bad = good;
    film->AddSample({{0, 0}, good, lambda, 1, {}});
    Float before = film->ToImage().Get({0, 0}, 0);
    bad[1] = std::numeric_limits<Float>::quiet_NaN();
    film->AddSample({{0, 0}, bad, lambda, 1, {}});
    bad[1] = Infinity;
    film->AddSample({{0, 0}, bad, lambda, 1, {}});
    EXPECT_EQ(film->RejectedSamples(), 2u);
    EXPECT_EQ(film->ToImage().Get({0, 0}, 0), before);
}

TEST_F(FilmTest, HalfPrecisionIsCutAndFloatIsNot) {
    Resolution(1, 1);
    SampledWavelengths lambda = SampledWavelengths::SampleVisible(0.4f);
    SampledSpectrum L = lambda.Pdf() * 1e6f;
    std::unique_ptr<Film> film = Make();
    film->AddSample({{0, 0}, L, lambda, 1, {}});
    EXPECT_EQ(film->ToImage().Format(), PixelFormat::Half);
    EXPECT_EQ(film->ToImage().Get({0, 0}, 1), 65504.0f);
    params_.Bool("savefp16", false);
    film = Make();
    film->AddSample({{0, 0}, L, lambda, 1, {}});
    EXPECT_EQ(film->ToImage().Format(), PixelFormat::Float);
    EXPECT_GT(film->ToImage().Get({0, 0}, 1), 65504.0f);
}

TEST_F(FilmTest, APictureThatDoesNotFitIsNotAllocated) {
    Resolution(100'000, 1'000'000);
    ExpectError([&] { Make(); }, {"Film \"rgb\"", "100000 x 1000000", "7.6 TB"});
    for (const char *type : {"gbuffer", "spectral"}) EXPECT_THROW(MakeFilm(type, params_, Context(), sink_), UserError);
    params_.Integers("pixelbounds", {500, 516, 999'000, 999'016});  // a small part of the picture fits into memory
    EXPECT_EQ(Make()->PixelBounds().Area(), 256);
    Resolution(100'000, 2'000'000);
    EXPECT_THROW(Make(), UserError);
}

TEST_F(FilmTest, RangesAreNamed) {
    params_.Number("diagonal", 1e38f);
    ExpectError([&] { Make(); }, {"\"diagonal\"", "1e+38", "above 0", "at most 1000000"});
}

}  // namespace
}  // namespace pbrt::test
