#include <gtest/gtest.h>

#include "media_test_support.h"
#include "pbrt/media/medium_kinds.h"

namespace pbrt::test {
namespace {

void ExpectEmission(const Medium &medium, const Point3 &p, const std::function<double(Float)> &expected) {
    const MediumCoefficients c = medium.At(p, kLambda);
    for (int k = 0; k < SpectrumSamples; ++k) {
        const double e = expected(std::round(kLambda[k]));
        EXPECT_NEAR(double(c.emission[k]), e, 1e-3 * std::abs(e) + 1e-9) << kLambda[k];
    }
}

TEST(Emission, LeIsNormalisedAsThatOfLights) {
    const auto medium = MakeMedium("homogeneous", Params().Rgb("Le", 1, 0.5f, 0.2f).Number("Lescale", 3));
    EXPECT_TRUE(medium->IsEmissive());
    const RgbIlluminantSpectrum le(ColorSpace::SRGB(), {1, 0.5f, 0.2f});
    // What lights of the same colour are divided by: the luminous part of the illuminant.
    double y = 0;
    for (Float nm = LambdaMin; nm <= LambdaMax; ++nm) y += double(CieY()(nm) * ColorSpace::SRGB().Illuminant()(nm));
    EXPECT_NEAR(y, double(CieYIntegral), 0.01);
    ExpectEmission(*medium, {0, 0, 0}, [&](Float nm) { return 3 * double(le(nm)) / y; });
    EXPECT_FALSE(MakeMedium("homogeneous", Params())->IsEmissive());
    EXPECT_FALSE(MakeMedium("homogeneous", Params().Rgb("Le", 0, 0, 0))->IsEmissive());
    // Without absorption nothing is emitted.
    EXPECT_FALSE(MakeMedium("homogeneous", Params().Rgb("Le", 1, 1, 1).Rgb("sigma_a", 0, 0, 0))->IsEmissive());
}

TEST(Emission, IsZeroInMediaThatAreNotEmissive) {
    for (const NamedMedium &m : AllMedia({})) {
        EXPECT_FALSE(m.medium->IsEmissive()) << m.name;
        Rng rng(1);
        for (int i = 0; i < 100; ++i) EXPECT_FALSE(m.medium->At(PointNear(m.bounds, rng), kLambda).emission) << m.name;
    }
}

TEST(Emission, ScaleMultipliesCoefficientsAndLescaleTheEmission) {
    auto make = [](Float scale, Float emissionScale) {
        return MakeMedium("homogeneous",
                          Params().Rgb("Le", 1, 1, 1).Number("scale", scale).Number("Lescale", emissionScale));
    };
    const auto one = make(1, 1), other = make(4, 2.5f);
    const MediumCoefficients a = one->At({0, 0, 0}, kLambda), b = other->At({0, 0, 0}, kLambda);
    for (int k = 0; k < SpectrumSamples; ++k) {
        EXPECT_NEAR(a.absorption[k], 1, 1e-6f);
        EXPECT_NEAR(b.absorption[k], 4, 1e-5f);
        EXPECT_NEAR(b.scattering[k], 4, 1e-5f);
        EXPECT_NEAR(b.emission[k], 2.5f * a.emission[k], 1e-5f * b.emission[k]);
    }
}

TEST(Emission, BlackBodyOfATemperature) {
    Params p = CountOf({2, 1, 1});
    p.Floats(ParamType::Float, "density", {1, 1}).Floats(ParamType::Float, "temperature", {500, 1500});
    p.Number("temperatureoffset", 200).Number("temperaturescale", 4).Floats(ParamType::Float, "Lescale", {1, 3});
    const auto medium = MakeMedium("uniformgrid", p);
    EXPECT_TRUE(medium->IsEmissive());
    // Linear between the centres of the voxels. Temperatures are taken at the very wavelengths.
    const MediumCoefficients cold = medium->At({0.01f, 0.5f, 0.5f}, kLambda);
    EXPECT_FALSE(cold.emission) << "the temperature fades outside the outermost centres, here below the offset";
    for (Float x : {0.25f, 0.5f, 0.6f, 0.75f}) {
        const Float w = (x - 0.25f) * 2, kelvin = (Lerp(w, Float(500), Float(1500)) - 200) * 4;
        const double peak = double(Blackbody(2.8977721e6f / kelvin, kelvin));
        const MediumCoefficients c = medium->At({x, 0.5f, 0.5f}, kLambda);
        for (int k = 0; k < SpectrumSamples; ++k) {
            const double expected = double(Lerp(w, Float(1), Float(3)) * Blackbody(kLambda[k], kelvin)) / peak;
            EXPECT_NEAR(double(c.emission[k]), expected, 1e-3 * expected) << x << ' ' << kLambda[k];
        }
    }
}

TEST(Emission, NoneAt100KelvinAndBelow) {
    auto emissionAt = [](Float kelvin) { return ThermalEmission().At(kelvin, kLambda).MaxComponent(); };
    EXPECT_EQ(emissionAt(100), 0);
    EXPECT_EQ(emissionAt(-5), 0);
    EXPECT_GT(emissionAt(3000), 0);
    const ThermalEmission shifted{1000, 0.5f, 2};
    EXPECT_EQ(shifted.At(1200, kLambda).MaxComponent(), 0);  // (1200 - 1000) / 2 = 100
    const SampledSpectrum body = BlackbodySpectrum(2000).Sample(kLambda), c = shifted.At(5000, kLambda);
    for (int k = 0; k < SpectrumSamples; ++k) EXPECT_NEAR(c[k], 2 * body[k], 1e-5f);
}

TEST(Emission, LeOfAUniformGridFadesFromTheMiddleOfTheBoxWithoutLescale) {
    Params plain = CountOf({2, 1, 1});
    plain.Floats(ParamType::Float, "density", {1, 2}).Rgb("Le", 1, 1, 1);
    Params scaled = plain;
    scaled.Floats(ParamType::Float, "Lescale", {5, 0});
    const auto a = MakeMedium("uniformgrid", plain), b = MakeMedium("uniformgrid", scaled);
    const RgbIlluminantSpectrum le(ColorSpace::SRGB(), Rgb(1));
    // As in stock pbrt-v4: a single voxel of 1, interpolated towards 0 outside the box.
    using Place = std::pair<Point3, double>;
    for (const auto &[p, share] : {Place({0.5f, 0.5f, 0.5f}, 1), Place({0.25f, 0.5f, 0.5f}, 0.75),
                                   Place({0.9f, 0.1f, 0.1f}, 0.216), Place({0.5f, 0.99f, 0.5f}, 0.51)})
        ExpectEmission(*a, p, [&, share = share](Float nm) { return share * double(le(nm) / CieYIntegral); });
    ExpectEmission(*b, {0.25f, 0.5f, 0.5f}, [&](Float nm) { return 5 * double(le(nm) / CieYIntegral); });
    ExpectEmission(*b, {0.5f, 0.5f, 0.5f}, [&](Float nm) { return 2.5 * double(le(nm) / CieYIntegral); });
    ExpectEmission(*b, {0.75f, 0.5f, 0.5f}, [&](Float) { return 0; });
}

TEST(Emission, LeOfAnRgbGridIsNotNormalised) {
    Params p;
    p.Rgb("sigma_a", 1, 1, 1).Rgb("Le", 0.3f, 0.8f, 0.1f).Number("Lescale", 0.02f).Number("scale", 7);
    const auto medium = MakeMedium("rgbgrid", p);
    EXPECT_TRUE(medium->IsEmissive());
    const RgbUnboundedSpectrum color(ColorSpace::SRGB(), {0.3f, 0.8f, 0.1f});
    const MediumCoefficients c = medium->At({0.5f, 0.5f, 0.5f}, kLambda);
    const SampledSpectrum expected = 0.02f * color.Sample(kLambda) * ColorSpace::SRGB().Illuminant().Sample(kLambda);
    for (int k = 0; k < SpectrumSamples; ++k) EXPECT_NEAR(c.emission[k], expected[k], 1e-5f * expected[k]);
}

}  // namespace
}  // namespace pbrt::test
