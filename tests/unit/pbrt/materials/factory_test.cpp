#include <gtest/gtest.h>

#include "material_test_support.h"
#include "support/errors.h"

namespace pbrt {
namespace {

using test::ExpectErrorAt;
using test::Params;
using test::Workshop;

TEST(MaterialFactory, UnknownTypeListsTheTypes) {
    Workshop shop;
    ExpectErrorAt([&] { shop.Make("diffus", Params("m", 7)); }, 7,
                  {"did you mean \"diffuse\"", "hair", "coatedconductor"});
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

TEST(MaterialFactory, BadParametersAreLocatedErrors) {
    struct {
        const char *type;
        Params params;
        int line;
        const char *word;
    } const kCases[] = {
        {"conductor", Params("m", 3).Rgb("k", 1, 1, 1).Rgb("reflectance", 1, 1, 1), 5, "\"k\""},
        {"coatedconductor", Params("m", 3).Rgb("reflectance", 1, 1, 1).NamedSpectrum("conductor.eta", "metal-Al-eta"),
         4, "conductor.eta"},
        {"diffuse", Params("m", 3).Rgb("reflectance", 1.2f, .5f, .5f), 4, ""},
        {"diffuse", Params("m", 3).Tex("reflectance", "none"), 4, ""},
        {"diffuse", Params("m", 3).S("normalmap", {"/none.png"}), 4, ""},
        {"conductor", Params("m", 3).F("roughness", -0.1f), 4, "it must be "},
        {"dielectric", Params("m", 3).F("vroughness", 1e30f), 4, "it must be "},
        {"dielectric", Params("m", 3).F("eta", 1e30f), 4, "it must be "},
        {"coateddiffuse", Params("m", 3).I("nsamples", 0), 4, "it must be "},
        {"coateddiffuse", Params("m", 3).I("nsamples", 2'000'000'000), 4, "it must be "},
        {"coatedconductor", Params("m", 3).I("maxdepth", -1), 4, "it must be "},
        {"subsurface", Params("m", 3).F("g", 1), 4, "it must be "},
    };
    for (const auto &c : kCases) {
        SCOPED_TRACE(c.type);
        Workshop shop;
        ExpectErrorAt([&] { shop.Make(c.type, c.params); }, c.line, {c.word});
    }
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
            SCOPED_TRACE(type);
            Workshop shop;
            ExpectErrorAt([&] { shop.Make(type, Params("m", 3).F(name, eta)); }, 4, {name, "positive"});
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

}  // namespace
}  // namespace pbrt
