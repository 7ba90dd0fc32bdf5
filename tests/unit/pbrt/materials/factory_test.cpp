#include <gtest/gtest.h>

#include "material_test_support.h"
#include "support/errors.h"

namespace pbrt {
namespace {

using test::Catch;
using test::Params;
using test::Thrown;
using test::Workshop;

TEST(MaterialFactory, UnknownTypeListsTheTypes) {
    Workshop shop;
    Thrown t = Catch([&] { shop.Make("diffus", Params("m", 7)); });
    EXPECT_EQ(t.line, 7);
    EXPECT_TRUE(t.Says("did you mean \"diffuse\"") && t.Says("hair") && t.Says("coatedconductor")) << t.message;
}

TEST(MaterialFactory, SupportedTypesCanBeMade) {
    for (const std::string &type : Materials().Names()) {
        Workshop shop;
        if (type == "mix" || type == "measured") continue;  // these two have required parameters
        EXPECT_NE(shop.Make(type), nullptr) << type;
        EXPECT_TRUE(shop.sink.All().empty()) << type;
    }
}

TEST(MaterialFactory, MisspeltParametersListTheChoices) {
    Workshop shop;
    shop.Make("coateddiffuse", Params("m", 3).F("roughnes", 1));
    ASSERT_EQ(shop.Errors(), 1u);
    EXPECT_EQ(shop.Last().loc.line, 4);
    test::ExpectWords(shop.Last().message, {"did you mean \"roughness\""});
    shop.Make("dielectric", Params("m", 13).I("roughness", 1));
    EXPECT_EQ(shop.Last().loc.line, 14);
    shop.Make("interface", Params("m", 23).Rgb("reflectance", 1, 1, 1));
    EXPECT_EQ(shop.Last().loc.line, 24);
    shop.Make("thindielectric", Params("m", 33).F("roughness", 1));
    EXPECT_EQ(shop.Last().loc.line, 34);
    EXPECT_EQ(shop.Errors(), 4u);
}

TEST(MaterialFactory, CommonRoughnessIsUnusedBesideBothOthers) {
    Workshop shop;
    shop.Make("conductor", Params("m", 3).F("uroughness", 1).F("vroughness", 1).F("roughness", 1));
    ASSERT_EQ(shop.Errors(), 1u);
    EXPECT_EQ(shop.Last().loc.line, 6);
}

TEST(MaterialFactory, ReflectanceExcludesIndex) {
    Workshop shop;
    Thrown t = Catch([&] { shop.Make("conductor", Params("m", 3).Rgb("k", 1, 1, 1).Rgb("reflectance", 1, 1, 1)); });
    EXPECT_EQ(t.line, 5);
    EXPECT_TRUE(t.Says("\"k\"")) << t.message;
    t = Catch([&] {
        shop.Make("coatedconductor",
                  Params("m", 3).Rgb("reflectance", 1, 1, 1).NamedSpectrum("conductor.eta", "metal-Al-eta"));
    });
    EXPECT_EQ(t.line, 4);
    EXPECT_TRUE(t.Says("conductor.eta")) << t.message;
}

TEST(MaterialFactory, BadValuesAreLocated) {
    Workshop shop;
    EXPECT_EQ(Catch([&] { shop.Make("diffuse", Params("m", 3).Rgb("reflectance", 1.2f, .5f, .5f)); }).line, 4);
    EXPECT_EQ(Catch([&] { shop.Make("diffuse", Params("m", 3).Tex("reflectance", "none")); }).line, 4);
    EXPECT_EQ(Catch([&] { shop.Make("coateddiffuse", Params("m", 3).I("nsamples", 0)); }).line, 4);
    EXPECT_EQ(Catch([&] { shop.Make("diffuse", Params("m", 3).S("normalmap", {"/none.png"})); }).line, 4);
}

TEST(MaterialFactory, IndicesOfRefractionArePositive) {
    const std::pair<const char *, const char *> kIndices[] = {{"dielectric", "eta"},
                                                              {"thindielectric", "eta"},
                                                              {"coateddiffuse", "eta"},
                                                              {"hair", "eta"},
                                                              {"coatedconductor", "interface.eta"},
                                                              {"subsurface", "eta"}};
    for (auto [type, name] : kIndices)
        for (Float eta : {0.f, -1.5f}) {
            Workshop shop;
            Thrown t = Catch([&] { shop.Make(type, Params("m", 3).F(name, eta)); });
            EXPECT_EQ(t.line, 4) << type;
            EXPECT_TRUE(t.Says(name) && t.Says("positive")) << t.message;
        }
}

TEST(MaterialFactory, InterfaceScattersNothing) {
    Workshop shop;
    MaterialPtr m = shop.Make("interface");
    SurfacePoint s = test::TestPoint();
    SampledWavelengths lambda = SampledWavelengths::SampleVisible(0.5f);
    EXPECT_TRUE(m->IsInterface());
    EXPECT_EQ(m->Resolve(s), nullptr);
    EXPECT_FALSE(m->GetBsdf(s, lambda));
    EXPECT_TRUE(shop.sink.All().empty());
    for (const char *old : {"", "none"}) {
        Workshop other;
        EXPECT_TRUE(other.Make(old)->IsInterface());
        ASSERT_EQ(other.sink.All().size(), 1u);
        EXPECT_EQ(other.sink.All()[0].severity, Severity::Warning);
    }
}

TEST(MaterialFactory, OthersResolveToThemselves) {
    Workshop shop;
    MaterialPtr m = shop.Make("diffuse");
    EXPECT_EQ(m->Resolve(test::TestPoint()), m.get());
    EXPECT_FALSE(m->IsInterface());
}

TEST(MaterialRanges, NumbersOutsideAreLocatedErrors) {
    test::Workshop shop;
    const std::vector<std::pair<const char *, test::Params>> bad = {
        {"conductor", test::Params("m", 4).F("roughness", -0.1f)},
        {"dielectric", test::Params("m", 4).F("vroughness", 1e30f)},
        {"dielectric", test::Params("m", 4).F("eta", 1e30f)},
        {"coateddiffuse", test::Params("m", 4).I("nsamples", 0)},
        {"coateddiffuse", test::Params("m", 4).I("nsamples", 2'000'000'000)},
        {"coatedconductor", test::Params("m", 4).I("maxdepth", -1)},
        {"subsurface", test::Params("m", 4).F("g", 1)}};
    for (const auto &[type, params] : bad) {
        const test::Thrown t = test::Catch([&] { shop.Make(type, params); });
        EXPECT_EQ(t.line, 5) << type;
        EXPECT_TRUE(t.Says("it must be ")) << t.message;
    }
}

}  // namespace
}  // namespace pbrt
