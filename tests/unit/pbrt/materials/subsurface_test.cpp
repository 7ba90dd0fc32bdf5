#include <gtest/gtest.h>

#include "material_test_support.h"
#include "pbrt/spectra/spectral_data.h"

namespace pbrt {
namespace {

using test::ExpectError;
using test::ExpectErrorAt;
using test::ExpectSameScattering;
using test::kLambda;
using test::Params;
using test::TestPoint;

class Subsurface : public testing::Test {
  protected:
    Bssrdf Of(const Params &params) {
        made_.push_back(shop_.Make("subsurface", params));  // the table of the material must outlive the returned value
        return *made_.back()->GetBssrdf(point_, kLambda);
    }
    Bssrdf By(const SampledSpectrum &sigmaA, const SampledSpectrum &sigmaS, const SubsurfaceTable &table) {
        return Bssrdf(point_.p, point_.shading.n, sigmaA, sigmaS, kLambda, table);
    }
    static SampledSpectrum Unbounded(Float r, Float g, Float b) {
        return RgbUnboundedSpectrum(ColorSpace::SRGB(), Rgb(r, g, b)).Sample(kLambda);
    }
    static void ExpectSame(const Bssrdf &a, const Bssrdf &b) {
        for (Float r : {.01f, .1f, .7f, 3.f})
            for (int i = 0; i < SpectrumSamples; ++i)
                EXPECT_NEAR(a.Profile(r)[i], b.Profile(r)[i], 1e-4f * std::abs(b.Profile(r)[i]) + 1e-9f) << r;
        const Point3 exit = TestPoint().p + Vector3(.1f, .1f, -.1f);
        EXPECT_NEAR(a.Pdf(exit, TestPoint().n), b.Pdf(exit, TestPoint().n), 1e-4f * b.Pdf(exit, TestPoint().n));
    }

    test::Workshop shop_;
    std::vector<MaterialPtr> made_;
    SurfacePoint point_ = TestPoint();
    const SubsurfaceTable plain_ = SubsurfaceTable::Compute(0, 1.33f);
};

TEST_F(Subsurface, FourWaysToSayIt) {
    const Bssrdf milk = By(Unbounded(.0011f, .0024f, .014f), Unbounded(2.55f, 3.21f, 3.77f), plain_);
    ExpectSame(Of(Params("m")), milk);
    ExpectSame(Of(Params("m").S("name", {"Wholemilk"})), milk);
    ExpectSame(Of(Params("m").Rgb("sigma_a", .0011f, .0024f, .014f).Rgb("sigma_s", 2.55f, 3.21f, 3.77f)), milk);
    const SubsurfaceTable other = SubsurfaceTable::Compute(.3f, 1.5f);
    ExpectSame(Of(Params("m").Rgb("sigma_a", .1f, .2f, .3f).Rgb("sigma_s", 1, 2, 3).F("g", .3f).F("eta", 1.5f)),
               By(Unbounded(.1f, .2f, .3f), Unbounded(1, 2, 3), other));
    EXPECT_TRUE(shop_.sink.All().empty());
}

TEST_F(Subsurface, ReflectanceIsWhatComesBack) {
    // The profile of one wavelength, integrated over the plane, is the reflectance; a constant texture gives the same
    // as a constant.
    shop_.Define("r", true, "constant", Params().Rgb("value", .7f, .5f, .3f));
    const Bssrdf plain = Of(Params("m").Rgb("reflectance", .7f, .5f, .3f).Rgb("mfp", 2, 1, .5f));
    ExpectSame(Of(Params("m").Tex("reflectance", "r").Rgb("mfp", 2, 1, .5f)), plain);
    const SampledSpectrum wanted = RgbAlbedoSpectrum(ColorSpace::SRGB(), Rgb(.7f, .5f, .3f)).Sample(kLambda);
    SampledSpectrum sum(0);
    constexpr int n = 10000;
    for (int i = 0; i < n; ++i) {  // r = 100 t^4
        const Float t = (static_cast<Float>(i) + .5f) / n, r = 100 * t * t * t * t;
        sum += plain.Profile(r) * (2 * Pi * r * 400 * t * t * t / n);
    }
    for (int i = 0; i < SpectrumSamples; ++i) EXPECT_NEAR(sum[i], wanted[i], 4e-3f);
}

TEST_F(Subsurface, ScaleMultipliesCoefficientsOrTheMeanFreePath) {
    ExpectSame(Of(Params("m").S("name", {"Skin1"}).F("scale", 10)),
               By(Unbounded(.32f, 1.7f, 4.8f), Unbounded(7.4f, 8.8f, 10.1f), plain_));
    ExpectSame(Of(Params("m").Rgb("reflectance", .5f, .5f, .5f).Rgb("mfp", 2, 2, 2).F("scale", .5f)),
               Of(Params("m").Rgb("reflectance", .5f, .5f, .5f)));
}

TEST_F(Subsurface, BoundaryIsADielectric) {
    SampledWavelengths lambda = kLambda;
    auto bsdf = [&](const char *type, const Params &params) {
        return shop_.Make(type, params)->GetBsdf(point_, lambda);
    };
    ExpectSameScattering(bsdf("subsurface", Params("m")), bsdf("dielectric", Params("m").F("eta", 1.33f)));
    ExpectSameScattering(bsdf("subsurface", Params("m").F("eta", 1.5f).F("uroughness", .2f).F("vroughness", .3f)),
                         bsdf("dielectric", Params("m").F("uroughness", .2f).F("vroughness", .3f)));
    ExpectSameScattering(bsdf("subsurface", Params("m").F("eta", 1.5f).F("roughness", .2f).B("remaproughness", false)),
                         bsdf("dielectric", Params("m").F("roughness", .2f).B("remaproughness", false)));
    EXPECT_FALSE(shop_.Make("dielectric")->GetBssrdf(point_, lambda));
}

TEST_F(Subsurface, MistakesAreNamed) {
    ExpectErrorAt([&] { Of(Params("m", 3).S("name", {"Skin3"})); }, 4, {"Skin3", "Skin1"});
    ExpectError([&] { Of(Params("m", 3).Rgb("sigma_a", 1, 1, 1)); }, {"\"sigma_s\""});
    ExpectError([&] { Of(Params("m", 3).F("g", 1)); }, {"\"g\""});
    ExpectError([&] { Of(Params("m", 3).F("eta", 0)); }, {"\"eta\""});
    EXPECT_TRUE(shop_.sink.All().empty());
    Of(Params("m", 3).S("name", {"Skin1"}).F("g", .5f));
    ASSERT_EQ(shop_.sink.All().size(), 1u);
    EXPECT_EQ(shop_.Errors(), 0u);
}

TEST_F(Subsurface, AllPresetsAreThere) {
    EXPECT_EQ(EmbeddedScatteringPresets().size(), 47u);
    for (const ScatteringPreset &preset : EmbeddedScatteringPresets())
        EXPECT_TRUE(shop_.Make("subsurface", Params("m").S("name", {preset.name}))->HasBssrdf()) << preset.name;
    EXPECT_TRUE(shop_.sink.All().empty());
}

TEST_F(Subsurface, NoFreePathStaysFinite) {
    const Bssrdf dense = Of(Params("m").Rgb("reflectance", 1, 1, 1).Rgb("mfp", 0, 0, 0));
    auto probe = dense.SampleProbe(.7f, {.4f, .2f});
    if (probe) {
        EXPECT_FALSE(std::isnan(probe->from.x) || std::isnan(probe->to.x));
    }
    EXPECT_FALSE(std::isnan(dense.Profile(.1f).Average()));
}

}  // namespace
}  // namespace pbrt
