#include <gtest/gtest.h>

#include "material_test_support.h"
#include "pbrt/math/rng.h"

// Each material is compared with a lobe that is built by hand from the same numbers.
namespace pbrt {
namespace {

using test::ExpectSameScattering;
using test::kLambda;
using test::Params;
using test::TestPoint;
using test::Workshop;

class Lobes : public testing::Test {
  protected:
    /// The BSDF of a material at the test point; fails if anything was reported.
    Bsdf Of(const std::string &type, const Params &params = Params("material")) {
        lambda_ = kLambda;
        MaterialPtr m = shop_.Make(type, params);
        EXPECT_EQ(shop_.Errors(), 0u);
        return m->GetBsdf(point_, lambda_);
    }
    template <class L>
    Bsdf By(const L &lobe) const {
        return Bsdf(point_.shading.n, point_.shading.dpdu, lobe);
    }
    static SampledSpectrum Albedo(Float r, Float g, Float b) {
        return RgbAlbedoSpectrum(ColorSpace::SRGB(), Rgb(r, g, b)).Sample(kLambda);
    }
    static SampledSpectrum Named(const std::string &name) { return NamedSpectrum(name)->Sample(kLambda); }
    static TrowbridgeReitz Rough(Float u, Float v) { return {std::sqrt(u), std::sqrt(v)}; }
    /// A conductor of eta = 1 whose k gives the reflectance r; both are divided by the index of the coat.
    static ConductorBxdf Mirror(const TrowbridgeReitz &t, const SampledSpectrum &r, Float coat = 1) {
        SampledSpectrum k;
        for (int i = 0; i < SpectrumSamples; ++i) k[i] = 2 * std::sqrt(r[i]) / std::sqrt(1 - r[i]);
        return {t, SampledSpectrum(1 / coat), k / coat};
    }

    Workshop shop_;
    SurfacePoint point_ = TestPoint();
    SampledWavelengths lambda_ = kLambda;
};

TEST_F(Lobes, Diffuse) {
    ExpectSameScattering(Of("diffuse"), By(DiffuseBxdf(SampledSpectrum(0.5f))));
    ExpectSameScattering(Of("diffuse", Params("m").Rgb("reflectance", .8f, .2f, .1f)),
                         By(DiffuseBxdf(Albedo(.8f, .2f, .1f))));
    shop_.Define("u", false, "bilerp", Params().F("v00", 0).F("v01", 0).F("v10", 10).F("v11", 10));
    shop_.Define("t", true, "scale", Params().Rgb("tex", .3f, .3f, .3f).Tex("scale", "u"));
    SampledSpectrum expected = Clamp(Albedo(.3f, .3f, .3f) * (10 * point_.uv.x), 0, 1);
    ExpectSameScattering(Of("diffuse", Params("m").Tex("reflectance", "t")), By(DiffuseBxdf(expected)));
    point_.uv.x = 0.9f;
    ExpectSameScattering(Of("diffuse", Params("m").Tex("reflectance", "t")), By(DiffuseBxdf(SampledSpectrum(1))));
}

TEST_F(Lobes, DiffuseTransmissionScalesThenClamps) {
    ExpectSameScattering(Of("diffusetransmission"),
                         By(DiffuseTransmissionBxdf(SampledSpectrum(.25f), SampledSpectrum(.25f))));
    ExpectSameScattering(
        Of("diffusetransmission",
           Params("m").Rgb("reflectance", .1f, .4f, .1f).Rgb("transmittance", .9f, .9f, .9f).F("scale", 1.5f)),
        By(DiffuseTransmissionBxdf(Albedo(.1f, .4f, .1f) * 1.5f, SampledSpectrum(1))));
}

TEST_F(Lobes, ConductorIsSmoothCopperByDefault) {
    ExpectSameScattering(Of("conductor"),
                         By(ConductorBxdf(TrowbridgeReitz(0, 0), Named("metal-Cu-eta"), Named("metal-Cu-k"))));
}

TEST_F(Lobes, ConductorIndexAndRoughness) {
    ExpectSameScattering(
        Of("conductor",
           Params("m").NamedSpectrum("eta", "metal-Au-eta").NamedSpectrum("k", "metal-Au-k").F("roughness", .2f)),
        By(ConductorBxdf(Rough(.2f, .2f), Named("metal-Au-eta"), Named("metal-Au-k"))));
    ExpectSameScattering(
        Of("conductor", Params("m").NamedSpectrum("k", "metal-Ag-k").F("uroughness", .05f).F("roughness", .5f)),
        By(ConductorBxdf(Rough(.05f, .5f), Named("metal-Cu-eta"), Named("metal-Ag-k"))));
    ExpectSameScattering(
        Of("conductor", Params("m").F("uroughness", .3f).F("vroughness", .1f).B("remaproughness", false)),
        By(ConductorBxdf({.3f, .1f}, Named("metal-Cu-eta"), Named("metal-Cu-k"))));
    shop_.Define("r", false, "bilerp", Params().F("v00", 0).F("v01", 0).F("v10", 1).F("v11", 1));
    ExpectSameScattering(
        Of("conductor", Params("m").Tex("roughness", "r")),
        By(ConductorBxdf(Rough(point_.uv.x, point_.uv.x), Named("metal-Cu-eta"), Named("metal-Cu-k"))));
}

TEST_F(Lobes, ConductorReflectanceIsReachedAtNormalIncidence) {
    ExpectSameScattering(Of("conductor", Params("m").Rgb("reflectance", .35f, .6f, .8f).F("roughness", .3f)),
                         By(Mirror(Rough(.3f, .3f), Albedo(.35f, .6f, .8f))));
    Bsdf mirror = Of("conductor", Params("m").Rgb("reflectance", .35f, .6f, .8f));
    auto sample = mirror.Sample(point_.n, 0, {0.5f, 0.5f});
    ASSERT_TRUE(sample);
    SampledSpectrum r = sample->f * AbsDot(sample->wi, point_.n) / sample->pdf;
    for (int i = 0; i < SpectrumSamples; ++i) EXPECT_NEAR(r[i], Albedo(.35f, .6f, .8f)[i], 1e-4f);
}

TEST_F(Lobes, PerfectReflectanceStaysFinite) {
    Bsdf b = Of("conductor", Params("m").Rgb("reflectance", 1, 1, 1).F("roughness", .3f));
    SampledSpectrum f = b.F(point_.wo, point_.n);
    EXPECT_FALSE(std::isnan(f.Average()));
    EXPECT_TRUE(std::isfinite(f.MaxComponent()) && f.MinComponent() > 0);
}

TEST_F(Lobes, Dielectric) {
    ExpectSameScattering(Of("dielectric"), By(DielectricBxdf(1.5f, TrowbridgeReitz(0, 0))));
    ExpectSameScattering(Of("dielectric", Params("m").F("eta", 1.8f).F("roughness", .1f)),
                         By(DielectricBxdf(1.8f, Rough(.1f, .1f))));
    ExpectSameScattering(Of("thindielectric", Params("m").F("eta", 1.8f)), By(ThinDielectricBxdf(1.8f)));
    EXPECT_FALSE(lambda_.SecondaryTerminated());
}

TEST_F(Lobes, DispersionKeepsTheFirstWavelength) {
    Float eta = (*NamedSpectrum("glass-F11"))(kLambda[0]);
    EXPECT_NE(eta, (*NamedSpectrum("glass-F11"))(kLambda[1]));
    auto glass = [](const char *name) { return Params("m").NamedSpectrum(name, "glass-F11"); };
    ExpectSameScattering(Of("dielectric", glass("eta")), By(DielectricBxdf(eta, TrowbridgeReitz(0, 0))));
    EXPECT_TRUE(lambda_.SecondaryTerminated());
    ExpectSameScattering(Of("thindielectric", glass("eta")), By(ThinDielectricBxdf(eta)));
    EXPECT_TRUE(lambda_.SecondaryTerminated());
    Of("coateddiffuse", glass("eta"));
    EXPECT_TRUE(lambda_.SecondaryTerminated());
    Of("coatedconductor", glass("interface.eta"));
    EXPECT_TRUE(lambda_.SecondaryTerminated());
}

TEST_F(Lobes, IndexBeyondItsTableIsOne) {
    ExpectSameScattering(Of("dielectric", Params("m").Spectrum("eta", {100, 1.5f, 200, 1.5f})),
                         By(DielectricBxdf(1, TrowbridgeReitz(0, 0))));
}

TEST_F(Lobes, CoatedDiffuse) {
    CoatedDiffuseBxdf clear(DielectricBxdf(1.5f, {0, 0}), DiffuseBxdf(SampledSpectrum(.5f)), .01f, SampledSpectrum(0),
                            0, 10, 1);
    clear.UseTable(*CoatTable::Shared(1.5f, .01f, 0));
    ExpectSameScattering(Of("coateddiffuse"), By(clear));
    // Both directions have the roughness of one texture.
    shop_.Define("r", false, "bilerp", Params().F("v00", .1f).F("v01", .1f).F("v10", .4f).F("v11", .4f));
    const Float roughness = Lerp(point_.uv.x, Float(.1), Float(.4));
    CoatedDiffuseBxdf rough(DielectricBxdf(1.5f, Rough(roughness, roughness)), DiffuseBxdf(SampledSpectrum(.5f)), .01f,
                            SampledSpectrum(0), 0, 10, 1);
    rough.UseTable(*CoatTable::Shared(1.5f, .01f, {}));
    ExpectSameScattering(Of("coateddiffuse", Params("m").Tex("roughness", "r")), By(rough));
    shop_.Define("t", false, "bilerp", Params().F("v00", 0).F("v01", 0).F("v10", 1).F("v11", 1));
    Params params = Params("m")
                        .Rgb("reflectance", .2f, .3f, .6f)
                        .F("uroughness", .1f)
                        .F("vroughness", .4f)
                        .F("eta", 1.3f)
                        .Tex("thickness", "t")
                        .Rgb("albedo", .2f, .6f, .8f)
                        .F("g", 3)
                        .I("maxdepth", 20)
                        .I("nsamples", 4);
    ExpectSameScattering(Of("coateddiffuse", params),
                         By(CoatedDiffuseBxdf(DielectricBxdf(1.3f, Rough(.1f, .4f)), DiffuseBxdf(Albedo(.2f, .3f, .6f)),
                                              point_.uv.x, Albedo(.2f, .6f, .8f), 1, 20, 4)));
}

TEST_F(Lobes, CoatedConductor) {
    ConductorBxdf copper({0, 0}, Named("metal-Cu-eta") / 1.5f, Named("metal-Cu-k") / 1.5f);
    ExpectSameScattering(Of("coatedconductor"), By(CoatedConductorBxdf(DielectricBxdf(1.5f, {0, 0}), copper, .01f,
                                                                       SampledSpectrum(0), 0, 10, 1)));
    Params params = Params("m")
                        .F("interface.roughness", .3f)
                        .F("interface.eta", 1.8f)
                        .NamedSpectrum("conductor.eta", "metal-Al-eta")
                        .NamedSpectrum("conductor.k", "metal-Al-k")
                        .F("conductor.uroughness", .4f)
                        .F("conductor.roughness", .1f)
                        .F("thickness", .3f)
                        .Rgb("albedo", .2f, .6f, .8f)
                        .F("g", -.3f)
                        .I("maxdepth", 20);
    ConductorBxdf aluminium(Rough(.4f, .1f), Named("metal-Al-eta") / 1.8f, Named("metal-Al-k") / 1.8f);
    ExpectSameScattering(Of("coatedconductor", params),
                         By(CoatedConductorBxdf(DielectricBxdf(1.8f, Rough(.3f, .3f)), aluminium, .3f,
                                                Albedo(.2f, .6f, .8f), -.3f, 20, 1)));
    ExpectSameScattering(
        Of("coatedconductor", Params("m").Rgb("reflectance", .75f, .35f, .5f).F("conductor.roughness", .4f)),
        By(CoatedConductorBxdf(DielectricBxdf(1.5f, {0, 0}), Mirror(Rough(.4f, .4f), Albedo(.75f, .35f, .5f), 1.5f),
                               .01f, SampledSpectrum(0), 0, 10, 1)));
}

/// Under white light from all directions no material reflects more than it receives, and a diffuse wall exactly its
/// reflectance.
TEST_F(Lobes, NoMaterialGainsEnergy) {
    struct Case {
        const char *type;
        Params params;
    };
    const Case cases[] = {
        {"diffuse", Params("m").Rgb("reflectance", 1, 1, 1)},
        {"diffusetransmission", Params("m").Rgb("reflectance", .5f, .5f, .5f).Rgb("transmittance", .5f, .5f, .5f)},
        {"conductor", Params("m").F("roughness", .3f)},
        {"dielectric", Params("m").F("roughness", .3f)},
        {"thindielectric", Params("m")},
        {"coateddiffuse", Params("m").F("roughness", .2f)},
        {"coatedconductor", Params("m").F("conductor.roughness", .2f)}};
    Rng rng(5);
    for (const Case &c : cases) {
        Bsdf b = Of(c.type, c.params);
        double sum = 0;
        constexpr int kSamples = 4000;
        for (int i = 0; i < kSamples; ++i) {
            Float uc = rng.Uniform();
            auto s = b.Sample(point_.wo, uc, rng.Uniform2(), TransportMode::Importance);
            if (s) sum += double(s->f[0]) * double(AbsDot(s->wi, point_.n)) / double(s->pdf);
        }
        EXPECT_LT(sum / kSamples, 1.03) << c.type;
        EXPECT_GT(sum / kSamples, 0.2) << c.type;
        if (std::string(c.type) == "diffuse") {
            EXPECT_NEAR(sum / kSamples, 1, 2e-3);
        }
    }
}

}  // namespace
}  // namespace pbrt
