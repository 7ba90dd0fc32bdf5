#include "pbrt/media/medium_factory.h"

#include <gtest/gtest.h>

#include "media_test_support.h"
#include "support/errors.h"

namespace pbrt::test {
namespace {

/// The first error that making the medium throws is at the parameter of number `line` (100: the directive).
void ExpectComplaint(const std::string &type, const ParamSet &params, int line, const std::string &part,
                     const Transform &place = {}) {
    DiagnosticSink sink;
    ExpectErrorAt([&] { MakeMedium(type, params, place, sink); }, line, {part});
}

Params Density(std::vector<Float> values) { return Params().Floats(ParamType::Float, "density", std::move(values)); }

TEST(MediumFactory, UnknownTypesListTheValidOnes) {
    ExpectComplaint("homogenous", Params(), 100, "did you mean \"homogeneous\"");
    EXPECT_EQ(Media().Names(), (std::vector<std::string>{"cloud", "homogeneous", "nanovdb", "rgbgrid", "uniformgrid"}));
}

TEST(MediumFactory, CoefficientsAreChecked) {
    ExpectComplaint("homogeneous", Params().Rgb("sigma_a", -1, 0, 0), 1, "negative");
    ExpectComplaint("homogeneous", Params().Floats(ParamType::Spectrum, "sigma_s", {400, 1, 500, -1}), 1, "at least 0");
    ExpectComplaint("homogeneous", Params().Number("g", 1.5f), 1, "\"g\" is 1.5");
    ExpectComplaint("homogeneous", Params().Number("scale", -2), 1, "\"scale\" is -2");
    ExpectComplaint("homogeneous", Params().Rgb("sigma_a", 1e29f, 1e29f, 1e29f).Number("scale", 100), 1,
                    "at most 1e+30");
    ExpectComplaint("homogeneous", Params().Floats(ParamType::Spectrum, "Le", {830, 0, 840, 1}), 1, "units.");
    ExpectComplaint("homogeneous", Params().Floats(ParamType::Spectrum, "Le", {588.2f, 0, 588.4f, 1, 588.6f, 0}), 1,
                    "narrower than 1 nm");
}

TEST(MediumFactory, PresetsComeBeforeCoefficients) {
    DiagnosticSink unknown;
    const auto medium = MakeMedium(
        "homogeneous", Params().String("preset", "Skin3").Rgb("sigma_a", 2, 2, 2).Rgb("sigma_s", 0, 0, 0), {}, unknown);
    EXPECT_FALSE(unknown.HasErrors());
    ASSERT_EQ(unknown.All().size(), 1u);
    EXPECT_EQ(unknown.All()[0].loc.line, 1);
    ExpectWords(unknown.All()[0].message, {"there is no preset \"Skin3\"", "Skin1"});
    const SampledSpectrum two = RgbUnboundedSpectrum(ColorSpace::SRGB(), Rgb(2)).Sample(kLambda);
    EXPECT_NEAR(medium->At({0, 0, 0}, kLambda).absorption[0], two[0], 1e-3f);
    EXPECT_EQ(medium->At({0, 0, 0}, kLambda).scattering[0], 0);

    DiagnosticSink both;
    MakeMedium("homogeneous", Params().String("preset", "Skin1").Rgb("sigma_a", 2, 2, 2), {}, both);
    ASSERT_EQ(both.All().size(), 1u);
    EXPECT_TRUE(both.HasErrors());
    ExpectWords(both.All()[0].message, {"unused"});
}

TEST(MediumFactory, DefaultsAreThoseOfStock) {
    const auto medium = MakeMedium("homogeneous", Params());
    const MediumCoefficients c = medium->At({0, 0, 0}, kLambda);
    for (int k = 0; k < SpectrumSamples; ++k) {
        EXPECT_EQ(c.absorption[k], 1);
        EXPECT_EQ(c.scattering[k], 1);
        EXPECT_EQ(c.emission[k], 0);
    }
    EXPECT_EQ(medium->Phase().G(), 0);
    EXPECT_GT(medium->Bytes(), 0u);
    // One voxel in the unit cube.
    const auto grid = MakeMedium("uniformgrid", Density({3}));
    EXPECT_NEAR(grid->At({0.5f, 0.5f, 0.5f}, kLambda).absorption[0], 3, 1e-5f);
    EXPECT_FALSE(grid->At({0.5f, 1.01f, 0.5f}, kLambda).absorption);
}

TEST(MediumFactory, GridsAreChecked) {
    ExpectComplaint("uniformgrid", Params().Integer("nx", 2), 100, "density");
    ExpectComplaint("uniformgrid", Density({1, 2, 3}).Integer("nx", 2), 1, "3 values; nx * ny * nz = 2 x 1 x 1 = 2");
    ExpectComplaint("uniformgrid", Density({1, -2}).Integer("nx", 2), 1, "value 2 of \"density\" is -2");
    ExpectComplaint("uniformgrid", Density({1, NAN}).Integer("nx", 2), 1, "value 2 of \"density\" is nan");
    ExpectComplaint("uniformgrid", Density({1}).Integer("nx", 0), 2, "\"nx\" is 0");
    ExpectComplaint("uniformgrid", Density({1e20f}).Number("scale", 1e20f), 1, "\"density\" is");
    ExpectComplaint("uniformgrid", Density({1}).Floats(ParamType::Float, "temperature", {1, 2}), 2, "2 values");
    ExpectComplaint("uniformgrid", Density({1}).Floats(ParamType::Float, "Lescale", {1, 2}), 2, "2 values");
    ExpectComplaint("uniformgrid", Density({1}).Floats(ParamType::Float, "Lescale", {-1}), 2, "value 1 of \"Lescale\"");
    ExpectComplaint("uniformgrid", Density({1}).Floats(ParamType::Float, "temperature", {900}).Rgb("Le", 1, 1, 1), 2,
                    "cannot be given together");
    ExpectComplaint("uniformgrid", Density({1}).Number("temperatureoffset", 1).Number("temperaturecutoff", 1), 3,
                    "the same parameter");
    ExpectComplaint("uniformgrid", Density({1}).Point("p1", {1, 0, 1}), 2, "the box is flat");
    ExpectComplaint("rgbgrid", Params(), 100, "\"rgb sigma_a\" or \"rgb sigma_s\"");
    ExpectComplaint("rgbgrid", Params().Rgb("sigma_s", 1, 1, 1).Rgb("Le", 1, 1, 1), 2, "needs \"rgb sigma_a\"");
    ExpectComplaint("rgbgrid", Params().Rgb("sigma_s", 1, 1, 1).Integer("nz", 3), 1, "1 values; nx * ny * nz");
    ExpectComplaint("rgbgrid", Params().Rgb("sigma_s", 1, -1, 1), 1, "-1");
    ExpectComplaint("rgbgrid", Params().Floats(ParamType::Rgb, "sigma_s", {1, 2}), 1, "sigma_s");
}

TEST(MediumFactory, TheAliasOfTheTemperatureOffset) {
    auto emission = [](const char *name) {
        return MakeMedium("uniformgrid",
                          Density({1}).Floats(ParamType::Float, "temperature", {3000}).Number(name, 1000))
            ->At({0.5f, 0.5f, 0.5f}, kLambda)
            .emission[0];
    };
    EXPECT_GT(emission("temperatureoffset"), 0);
    EXPECT_EQ(emission("temperatureoffset"), emission("temperaturecutoff"));
}

TEST(MediumFactory, PlacesAreChecked) {
    const Transform flat = Transform::Scale({1, 0, 1});
    for (const char *type : {"uniformgrid", "rgbgrid", "cloud", "nanovdb"}) {
        Params p;
        if (type == std::string("uniformgrid")) p.Floats(ParamType::Float, "density", {1});
        if (type == std::string("rgbgrid")) p.Rgb("sigma_a", 1, 1, 1);
        if (type == std::string("nanovdb")) p.String("filename", kBlob);
        ExpectComplaint(type, p, 100, "cannot be inverted", flat);
        ExpectComplaint(type, p, 100, "projection", Transform::Perspective(60, 1, 10));
    }
    // Homogeneous media are everywhere, so any transformation will do.
    EXPECT_TRUE(MakeMedium("homogeneous", Params(), flat));
}

TEST(MediumFactory, UnknownParametersAreErrors) {
    for (const auto &[type, name] : std::vector<std::pair<const char *, const char *>>{
             {"homogeneous", "LeScale"}, {"cloud", "scale"}, {"homogeneous", "density"}}) {
        DiagnosticSink sink;
        MakeMedium(type, Params().Number(name, 1), {}, sink);
        EXPECT_TRUE(sink.HasErrors()) << type << ' ' << name;
    }
}

}  // namespace
}  // namespace pbrt::test
