#include <gtest/gtest.h>

#include "material_test_support.h"
#include "pbrt/math/rng.h"

namespace pbrt::test {
namespace {

class Lobes : public MaterialTest {
  protected:
    static SampledSpectrum Named(const std::string &name) { return NamedSpectrum(name)->Sample(kLambda); }
    static TrowbridgeReitz Rough(Float u, Float v) { return {std::sqrt(u), std::sqrt(v)}; }
    static TrowbridgeReitz Rough(Float r) { return Rough(r, r); }
    static ConductorBxdf Copper(const TrowbridgeReitz &t, Float coat = 1) {
        return {t, Named("metal-Cu-eta") / coat, Named("metal-Cu-k") / coat};
    }
    /// A conductor of eta = 1 whose k gives the reflectance r; both are divided by the index of the coat.
    static ConductorBxdf Mirror(const TrowbridgeReitz &t, const SampledSpectrum &r, Float coat = 1) {
        SampledSpectrum k;
        for (int i = 0; i < SpectrumSamples; ++i) k[i] = 2 * std::sqrt(r[i]) / std::sqrt(1 - r[i]);
        return {t, SampledSpectrum(1 / coat), k / coat};
    }
    /// A clear coat with the defaults of the format.
    static CoatedDiffuseBxdf CoatedGrey(const TrowbridgeReitz &t) {
        return {DielectricBxdf(1.5f, t), DiffuseBxdf(SampledSpectrum(.5f)), .01f, SampledSpectrum(0), 0, 10, 1};
    }
    static CoatedConductorBxdf Coated(const ConductorBxdf &metal) {
        return {DielectricBxdf(1.5f, {0, 0}), metal, .01f, SampledSpectrum(0), 0, 10, 1};
    }
};

TEST_F(Lobes, Diffuse) {
    ExpectLobe("diffuse", Params(), DiffuseBxdf(SampledSpectrum(0.5f)));
    ExpectLobe("diffuse", Params().Rgb("reflectance", .8f, .2f, .1f), DiffuseBxdf(Albedo(.8f, .2f, .1f)));
    shop_.Define("u", false, "bilerp", Ramp(0, 10));
    shop_.Define("t", true, "scale", Params().Rgb("tex", .3f, .3f, .3f).Texture("scale", "u"));
    ExpectLobe("diffuse", Params().Texture("reflectance", "t"),
               DiffuseBxdf(Clamp(Albedo(.3f, .3f, .3f) * (10 * point_.uv.x), 0, 1)));
    point_.uv.x = 0.9f;
    ExpectLobe("diffuse", Params().Texture("reflectance", "t"), DiffuseBxdf(SampledSpectrum(1)));
}

TEST_F(Lobes, DiffuseTransmissionScalesThenClamps) {
    const SampledSpectrum quarter(.25f);
    ExpectLobe("diffusetransmission", Params(), DiffuseTransmissionBxdf(quarter, quarter));
    ExpectLobe("diffusetransmission",
               Params().Rgb("reflectance", .1f, .4f, .1f).Rgb("transmittance", .9f, .9f, .9f).Number("scale", 1.5f),
               DiffuseTransmissionBxdf(Albedo(.1f, .4f, .1f) * 1.5f, SampledSpectrum(1)));
}

TEST_F(Lobes, ConductorIndexAndRoughness) {
    ExpectLobe("conductor", Params(), Copper({0, 0}));
    Params gold = Params().NamedSpectrum("eta", "metal-Au-eta").NamedSpectrum("k", "metal-Au-k");
    ExpectLobe("conductor", gold.Number("roughness", .2f),
               ConductorBxdf(Rough(.2f), Named("metal-Au-eta"), Named("metal-Au-k")));
    ExpectLobe("conductor",
               Params().NamedSpectrum("k", "metal-Ag-k").Number("uroughness", .05f).Number("roughness", .5f),
               ConductorBxdf(Rough(.05f, .5f), Named("metal-Cu-eta"), Named("metal-Ag-k")));
    ExpectLobe("conductor", Params().Number("uroughness", .3f).Number("vroughness", .1f).Bool("remaproughness", false),
               Copper({.3f, .1f}));
    shop_.Define("r", false, "bilerp", Ramp());
    ExpectLobe("conductor", Params().Texture("roughness", "r"), Copper(Rough(point_.uv.x)));
}

TEST_F(Lobes, ConductorReflectanceIsReachedAtNormalIncidence) {
    const Params colored = Params().Rgb("reflectance", .35f, .6f, .8f);
    ExpectLobe("conductor", Params(colored).Number("roughness", .3f), Mirror(Rough(.3f), Albedo(.35f, .6f, .8f)));
    auto sample = Of("conductor", colored).Sample(point_.n, 0, {0.5f, 0.5f});
    ASSERT_TRUE(sample);
    ExpectNear(sample->f * AbsDot(sample->wi, point_.n) / sample->pdf, Albedo(.35f, .6f, .8f), 1e-4f);
}

TEST_F(Lobes, PerfectReflectanceStaysFinite) {
    Bsdf b = Of("conductor", Params().Rgb("reflectance", 1, 1, 1).Number("roughness", .3f));
    SampledSpectrum f = b.F(point_.wo, point_.n);
    EXPECT_FALSE(std::isnan(f.Average()));
    EXPECT_TRUE(std::isfinite(f.MaxComponent()) && f.MinComponent() > 0);
}

TEST_F(Lobes, Dielectric) {
    ExpectLobe("dielectric", Params(), DielectricBxdf(1.5f, {0, 0}));
    ExpectLobe("dielectric", Params().Number("eta", 1.8f).Number("roughness", .1f), DielectricBxdf(1.8f, Rough(.1f)));
    ExpectLobe("thindielectric", Params().Number("eta", 1.8f), ThinDielectricBxdf(1.8f));
    EXPECT_FALSE(lambda_.SecondaryTerminated());
    // An index beyond its table is 1.
    ExpectLobe("dielectric", Params().Spectrum("eta", {100, 1.5f, 200, 1.5f}), DielectricBxdf(1, {0, 0}));
}

TEST_F(Lobes, DispersionKeepsTheFirstWavelength) {
    Float eta = (*NamedSpectrum("glass-F11"))(kLambda[0]);
    EXPECT_NE(eta, (*NamedSpectrum("glass-F11"))(kLambda[1]));
    auto glass = [](const char *name) { return Params().NamedSpectrum(name, "glass-F11"); };
    ExpectLobe("dielectric", glass("eta"), DielectricBxdf(eta, {0, 0}));
    EXPECT_TRUE(lambda_.SecondaryTerminated());
    ExpectLobe("thindielectric", glass("eta"), ThinDielectricBxdf(eta));
    EXPECT_TRUE(lambda_.SecondaryTerminated());
    Of("coateddiffuse", glass("eta"));
    EXPECT_TRUE(lambda_.SecondaryTerminated());
    Of("coatedconductor", glass("interface.eta"));
    EXPECT_TRUE(lambda_.SecondaryTerminated());
}

TEST_F(Lobes, CoatedDiffuse) {
    CoatedDiffuseBxdf clear = CoatedGrey({0, 0});
    clear.UseTable(*CoatTable::Shared(1.5f, .01f, 0));
    ExpectLobe("coateddiffuse", Params(), clear);
    // Both directions have the roughness of one texture.
    shop_.Define("r", false, "bilerp", Ramp(.1f, .4f));
    CoatedDiffuseBxdf rough = CoatedGrey(Rough(Lerp(point_.uv.x, Float(.1), Float(.4))));
    rough.UseTable(*CoatTable::Shared(1.5f, .01f, {}));
    ExpectLobe("coateddiffuse", Params().Texture("roughness", "r"), rough);
    shop_.Define("t", false, "bilerp", Ramp());
    Params params = Params().Rgb("reflectance", .2f, .3f, .6f).Rgb("albedo", .2f, .6f, .8f).Texture("thickness", "t");
    params.Number("uroughness", .1f).Number("vroughness", .4f).Number("eta", 1.3f).Number("g", 3);
    ExpectLobe("coateddiffuse", params.Integer("maxdepth", 20).Integer("nsamples", 4),
               CoatedDiffuseBxdf(DielectricBxdf(1.3f, Rough(.1f, .4f)), DiffuseBxdf(Albedo(.2f, .3f, .6f)), point_.uv.x,
                                 Albedo(.2f, .6f, .8f), 1, 20, 4));
}

TEST_F(Lobes, CoatedConductor) {
    ExpectLobe("coatedconductor", Params(), Coated(Copper({0, 0}, 1.5f)));
    Params params = Params().NamedSpectrum("conductor.eta", "metal-Al-eta").NamedSpectrum("conductor.k", "metal-Al-k");
    params.Number("interface.roughness", .3f).Number("interface.eta", 1.8f);
    params.Number("conductor.uroughness", .4f).Number("conductor.roughness", .1f);
    params.Number("thickness", .3f).Rgb("albedo", .2f, .6f, .8f).Number("g", -.3f).Integer("maxdepth", 20);
    ConductorBxdf aluminium(Rough(.4f, .1f), Named("metal-Al-eta") / 1.8f, Named("metal-Al-k") / 1.8f);
    ExpectLobe(
        "coatedconductor", params,
        CoatedConductorBxdf(DielectricBxdf(1.8f, Rough(.3f)), aluminium, .3f, Albedo(.2f, .6f, .8f), -.3f, 20, 1));
    ExpectLobe("coatedconductor", Params().Rgb("reflectance", .75f, .35f, .5f).Number("conductor.roughness", .4f),
               Coated(Mirror(Rough(.4f), Albedo(.75f, .35f, .5f), 1.5f)));
}

/// Under white light from all directions no material reflects more than it receives, and a diffuse wall exactly its
/// reflectance.
TEST_F(Lobes, NoMaterialGainsEnergy) {
    const std::pair<std::string, Params> cases[] = {
        {"diffuse", Params().Rgb("reflectance", 1, 1, 1)},
        {"diffusetransmission", Params().Rgb("reflectance", .5f, .5f, .5f).Rgb("transmittance", .5f, .5f, .5f)},
        {"conductor", Params().Number("roughness", .3f)},
        {"dielectric", Params().Number("roughness", .3f)},
        {"thindielectric", Params()},
        {"coateddiffuse", Params().Number("roughness", .2f)},
        {"coatedconductor", Params().Number("conductor.roughness", .2f)}};
    Rng rng(5);
    for (const auto &[type, params] : cases) {
        Bsdf b = Of(type, params);
        double sum = 0;
        constexpr int kSamples = 4000;
        for (int i = 0; i < kSamples; ++i) {
            Float uc = rng.Uniform();
            auto s = b.Sample(point_.wo, uc, rng.Uniform2(), TransportMode::Importance);
            if (s) sum += double(s->f[0]) * double(AbsDot(s->wi, point_.n)) / double(s->pdf);
        }
        EXPECT_LT(sum / kSamples, type == "diffuse" ? 1.002 : 1.03) << type;
        EXPECT_GT(sum / kSamples, type == "diffuse" ? 0.998 : 0.2) << type;
    }
}

}  // namespace
}  // namespace pbrt::test
