#include <gtest/gtest.h>

#include "material_test_support.h"

namespace pbrt::test {
namespace {

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
    shop.Make("coateddiffuse", Params("m", 3).Number("roughnes", 1));
    shop.Make("dielectric", Params("m", 13).Integer("roughness", 1));
    shop.Make("interface", Params("m", 23).Rgb("reflectance", 1, 1, 1));
    shop.Make("thindielectric", Params("m", 33).Number("roughness", 1));
    shop.ExpectErrors({4, 14, 24, 34}, {"did you mean \"roughness\""});
}

TEST(MaterialFactory, CommonRoughnessIsUnusedBesideBothOthers) {
    Workshop shop;
    shop.Make("conductor", Params("m", 3).Number("uroughness", 1).Number("vroughness", 1).Number("roughness", 1));
    shop.ExpectErrors({6});
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
        {"diffuse", Params("m", 3).Texture("reflectance", "none"), 4, ""},
        {"diffuse", Params("m", 3).String("normalmap", "/none.png"), 4, ""},
        {"conductor", Params("m", 3).Number("roughness", -0.1f), 4, "it must be "},
        {"dielectric", Params("m", 3).Number("vroughness", 1e30f), 4, "it must be "},
        {"dielectric", Params("m", 3).Number("eta", 1e30f), 4, "it must be "},
        {"coateddiffuse", Params("m", 3).Integer("nsamples", 0), 4, "it must be "},
        {"coateddiffuse", Params("m", 3).Integer("nsamples", 2'000'000'000), 4, "it must be "},
        {"coatedconductor", Params("m", 3).Integer("maxdepth", -1), 4, "it must be "},
        {"subsurface", Params("m", 3).Number("g", 1), 4, "it must be "},
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
            ExpectErrorAt([&] { shop.Make(type, Params("m", 3).Number(name, eta)); }, 4, {name, "positive"});
        }
}

TEST(MaterialFactory, InterfaceScattersNothing) {
    Workshop shop;
    MaterialPtr m = shop.Make("interface"), diffuse = shop.Make("diffuse");
    SurfacePoint s = TestPoint();
    SampledWavelengths lambda = kLambda;
    EXPECT_TRUE(m->IsInterface());
    EXPECT_EQ(m->Resolve(s), nullptr);
    EXPECT_FALSE(m->GetBsdf(s, lambda));
    EXPECT_EQ(diffuse->Resolve(s), diffuse.get());
    EXPECT_FALSE(diffuse->IsInterface());
    EXPECT_TRUE(shop.sink.All().empty());
    for (const char *old : {"", "none"}) {
        Workshop other;
        EXPECT_TRUE(other.Make(old)->IsInterface());
        ASSERT_EQ(other.sink.All().size(), 1u);
        EXPECT_EQ(other.sink.All()[0].severity, Severity::Warning);
    }
}

}  // namespace
}  // namespace pbrt::test
