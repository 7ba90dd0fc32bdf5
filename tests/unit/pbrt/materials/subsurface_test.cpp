#include <gtest/gtest.h>

#include "material_test_support.h"
#include "pbrt/spectra/spectrum.h"

namespace pbrt::test {
namespace {

class Subsurface : public MaterialTest {
  protected:
    Bssrdf BssrdfOf(const Params &params) {
        made_.push_back(shop_.Make("subsurface", params));  // the table of the material must outlive the returned value
        return *made_.back()->GetBssrdf(point_, kLambda);
    }
    Bssrdf By(const SampledSpectrum &sigmaA, const SampledSpectrum &sigmaS, const SubsurfaceTable &table) {
        return Bssrdf(point_.p, point_.shading.n, sigmaA, sigmaS, kLambda, table);
    }
    static void ExpectSame(const Bssrdf &a, const Bssrdf &b) {
        for (Float r : {.01f, .1f, .7f, 3.f})
            for (int i = 0; i < SpectrumSamples; ++i)
                EXPECT_NEAR(a.Profile(r)[i], b.Profile(r)[i], 1e-4f * std::abs(b.Profile(r)[i]) + 1e-9f) << r;
        const Point3 exit = TestPoint().p + Vector3(.1f, .1f, -.1f);
        EXPECT_NEAR(a.Pdf(exit, TestPoint().n), b.Pdf(exit, TestPoint().n), 1e-4f * b.Pdf(exit, TestPoint().n));
    }

    std::vector<MaterialPtr> made_;
    const SubsurfaceTable plain_ = SubsurfaceTable::Compute(0, 1.33f);
};

TEST_F(Subsurface, FourSetsOfParametersGiveOneMedium) {
    const Bssrdf milk = By(Unbounded(.0011f, .0024f, .014f), Unbounded(2.55f, 3.21f, 3.77f), plain_);
    ExpectSame(BssrdfOf(Params()), milk);
    ExpectSame(BssrdfOf(Params().String("name", "Wholemilk")), milk);
    ExpectSame(BssrdfOf(Params().Rgb("sigma_a", .0011f, .0024f, .014f).Rgb("sigma_s", 2.55f, 3.21f, 3.77f)), milk);
    const SubsurfaceTable other = SubsurfaceTable::Compute(.3f, 1.5f);
    ExpectSame(
        BssrdfOf(Params().Rgb("sigma_a", .1f, .2f, .3f).Rgb("sigma_s", 1, 2, 3).Number("g", .3f).Number("eta", 1.5f)),
        By(Unbounded(.1f, .2f, .3f), Unbounded(1, 2, 3), other));
    EXPECT_TRUE(shop_.sink.All().empty());
}

TEST_F(Subsurface, ReflectanceIsWhatComesBack) {
    // The profile of one wavelength, integrated over the plane, is the reflectance; a constant texture gives the same
    // as a constant.
    shop_.Define("r", true, "constant", Params().Rgb("value", .7f, .5f, .3f));
    const Bssrdf plain = BssrdfOf(Params().Rgb("reflectance", .7f, .5f, .3f).Rgb("mfp", 2, 1, .5f));
    ExpectSame(BssrdfOf(Params().Texture("reflectance", "r").Rgb("mfp", 2, 1, .5f)), plain);
    const SampledSpectrum wanted = Albedo(.7f, .5f, .3f);
    SampledSpectrum sum(0);
    constexpr int n = 10000;
    for (int i = 0; i < n; ++i) {  // r = 100 t^4
        const Float t = (Float(i) + .5f) / n, r = 100 * t * t * t * t;
        sum += plain.Profile(r) * (2 * Pi * r * 400 * t * t * t / n);
    }
    ExpectNear(sum, wanted, 4e-3f);
}

TEST_F(Subsurface, ScaleMultipliesCoefficientsOrTheMeanFreePath) {
    ExpectSame(BssrdfOf(Params().String("name", "Skin1").Number("scale", 10)),
               By(Unbounded(.32f, 1.7f, 4.8f), Unbounded(7.4f, 8.8f, 10.1f), plain_));
    ExpectSame(BssrdfOf(Params().Rgb("reflectance", .5f, .5f, .5f).Rgb("mfp", 2, 2, 2).Number("scale", .5f)),
               BssrdfOf(Params().Rgb("reflectance", .5f, .5f, .5f)));
}

TEST_F(Subsurface, BoundaryIsADielectric) {
    auto expectDielectric = [&](const Params &params, const Params &dielectric) {
        ExpectSameScattering(Of("subsurface", params), Of("dielectric", dielectric));
    };
    expectDielectric(Params(), Params().Number("eta", 1.33f));
    expectDielectric(Params().Number("eta", 1.5f).Number("uroughness", .2f).Number("vroughness", .3f),
                     Params().Number("uroughness", .2f).Number("vroughness", .3f));
    expectDielectric(Params().Number("eta", 1.5f).Number("roughness", .2f).Bool("remaproughness", false),
                     Params().Number("roughness", .2f).Bool("remaproughness", false));
    EXPECT_FALSE(shop_.Make("dielectric")->GetBssrdf(point_, lambda_));
}

TEST_F(Subsurface, MistakesAreNamed) {
    ExpectErrorAt([&] { BssrdfOf(Params("m", 3).String("name", "Skin3")); }, 4, {"Skin3", "Skin1"});
    ExpectError([&] { BssrdfOf(Params("m", 3).Rgb("sigma_a", 1, 1, 1)); }, {"\"sigma_s\""});
    ExpectError([&] { BssrdfOf(Params("m", 3).Number("g", 1)); }, {"\"g\""});
    ExpectError([&] { BssrdfOf(Params("m", 3).Number("eta", 0)); }, {"\"eta\""});
    EXPECT_TRUE(shop_.sink.All().empty());
    BssrdfOf(Params("m", 3).String("name", "Skin1").Number("g", .5f));
    ASSERT_EQ(shop_.sink.All().size(), 1u);
    EXPECT_EQ(shop_.Errors(), 0u);
}

TEST_F(Subsurface, AllPresetsAreThere) {
    EXPECT_EQ(EmbeddedScatteringPresets().size(), 47u);
    for (const ScatteringPreset &preset : EmbeddedScatteringPresets())
        EXPECT_TRUE(shop_.Make("subsurface", Params().String("name", preset.name))->HasBssrdf()) << preset.name;
    EXPECT_TRUE(shop_.sink.All().empty());
}

TEST_F(Subsurface, NoFreePathStaysFinite) {
    const Bssrdf dense = BssrdfOf(Params().Rgb("reflectance", 1, 1, 1).Rgb("mfp", 0, 0, 0));
    auto probe = dense.SampleProbe(.7f, {.4f, .2f});
    if (probe) {
        EXPECT_FALSE(std::isnan(probe->from.x) || std::isnan(probe->to.x));
    }
    EXPECT_FALSE(std::isnan(dense.Profile(.1f).Average()));
}

}  // namespace
}  // namespace pbrt::test
