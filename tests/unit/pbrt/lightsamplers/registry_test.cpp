#include "pbrt/lightsamplers/registry.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "support/errors.h"

namespace pbrt {
namespace {

struct SomeParams {
    int leaves = 7;
    template <class V>
    void Describe(V &&v) {
        v("leaves", leaves, Range{1, 100}, "how many");
    }
};

void AddSome(LightSamplerRegistry &registry) {
    registry.samplers.Add<SomeParams>("some", "some sampler",
                                      [](const auto &, const ParamSet &, const LightGroups &) { return nullptr; });
}

TEST(LightSamplerRegistry, StockSamplers) {
    LightSamplerRegistry registry;
    RegisterStockLightSamplers(registry);
    EXPECT_EQ(registry.samplers.Names(), (std::vector<std::string>{"bvh", "exhaustive", "power", "uniform"}));
    LightTable none;
    none.Finish({0, 0, 0}, 1);
    for (const std::string &name : registry.samplers.Names()) {
        const auto &entry = registry.samplers.Find(name);
        EXPECT_TRUE(entry.traits.takesGroups);
        EXPECT_TRUE(entry.make(ParamSet(), none.ByComponent()));
    }
}

TEST(LightSamplerRegistry, UnknownNameListsTheValidOnes) {
    LightSamplerRegistry registry;
    RegisterStockLightSamplers(registry);
    auto file = std::make_shared<SourceFile>(SourceFile{"x.pbrt", ""});
    test::ExpectErrorAt(
        [&] {
            registry.samplers.Find("exhaustve", FileLoc{file, 3, 1});
        },
        3, {"\"exhaustive\"", "bvh, exhaustive, power, uniform"});
}

TEST(LightSamplerRegistry, NameUsedTwiceThrows) {
    LightSamplerRegistry registry;
    AddSome(registry);
    EXPECT_THROW(AddSome(registry), std::logic_error);
    RegisterStockLightSamplers(registry);
    EXPECT_THROW(RegisterStockLightSamplers(registry), std::logic_error);
}

TEST(LightSamplerRegistry, ListingNamesEverything) {
    LightSamplerRegistry registry;
    AddSome(registry);
    std::string text = registry.Listing();
    for (const char *part : {"some", "some sampler", "integer some.leaves = 7", "1 to 100", "how many"})
        EXPECT_NE(text.find(part), std::string::npos) << part << " in\n" << text;
}

}  // namespace
}  // namespace pbrt
