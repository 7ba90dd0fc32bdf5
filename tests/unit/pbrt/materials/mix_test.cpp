#include <gtest/gtest.h>

#include "material_test_support.h"
#include "pbrt/math/rng.h"
#include "support/statistics.h"

namespace pbrt::test {
namespace {

struct MixShop : Workshop {
    MixShop() {
        named["a"] = Make("diffuse");
        named["b"] = Make("conductor");
        named["c"] = Make("dielectric");
        named["air"] = Make("interface");
    }
    MaterialPtr Mix(const std::string &x, const std::string &y, Float amount) {
        return Make("mix", Params("mix").Strings("materials", {x, y}).Number("amount", amount));
    }
};

SurfacePoint RandomPoint(Rng &rng) {
    SurfacePoint s = TestPoint();
    s.p = {rng.Uniform(), rng.Uniform(), rng.Uniform()};
    s.uv = rng.Uniform2();
    return s;
}

/// Expects that `mix` resolves to `m` at the share `expected` of random points, within the noise.
void ExpectShare(const Material &mix, const Material *m, double expected, bool sameP = false) {
    Rng rng(11);
    constexpr int kPoints = 40000;
    int hits = 0;
    for (int i = 0; i < kPoints; ++i) {
        SurfacePoint s = RandomPoint(rng);
        if (sameP) {
            s.p = {1, 1, 1};
            s.wo = Normalize(Vector3(s.uv.x, s.uv.y, 1));
        }
        hits += mix.Resolve(s) == m;
    }
    double z = (hits - kPoints * expected) / std::sqrt(kPoints * expected * (1 - expected));
    EXPECT_GT(NormalTail(z), 1e-4) << "share " << double(hits) / kPoints << ", expected " << expected;
}

TEST(MixMaterial, SecondIsChosenWithProbabilityAmount) {
    MixShop shop;
    for (Float amount : {0.1f, 0.35f, 0.8f}) {
        MaterialPtr mix = shop.Mix("a", "b", amount);
        ExpectShare(*mix, shop.named["b"].get(), double(amount));
        ExpectShare(*mix, shop.named["a"].get(), 1 - double(amount));
    }
    ExpectShare(*shop.Make("mix", Params("mix").Strings("materials", {"a", "b"})), shop.named["b"].get(), 0.5);
}

TEST(MixMaterial, DirectionsAtOnePointDifferToo) {
    MixShop shop;
    ExpectShare(*shop.Mix("a", "b", 0.35f), shop.named["b"].get(), 0.35, true);
}

TEST(MixMaterial, EndsOfTheAmountAreCertain) {
    MixShop shop;
    MaterialPtr first = shop.Mix("a", "b", 0), second = shop.Mix("a", "b", 1);
    Rng rng(2);
    for (int i = 0; i < 2000; ++i) {
        SurfacePoint s = RandomPoint(rng);
        ASSERT_EQ(first->Resolve(s), shop.named["a"].get());
        ASSERT_EQ(second->Resolve(s), shop.named["b"].get());
    }
}

TEST(MixMaterial, ChoiceIsTheSameEveryTime) {
    MixShop one, two;
    MaterialPtr m = one.Mix("a", "b", 0.5f), n = two.Mix("a", "b", 0.5f);
    Rng rng(3);
    for (int i = 0; i < 500; ++i) {
        SurfacePoint s = RandomPoint(rng);
        ASSERT_EQ(m->Resolve(s) == one.named["a"].get(), n->Resolve(s) == two.named["a"].get());
        ASSERT_EQ(m->Resolve(s), m->Resolve(s));
    }
}

TEST(MixMaterial, NestedChoicesAreIndependent) {
    MixShop shop;
    shop.named["inner"] = shop.Mix("a", "b", 0.4f);
    MaterialPtr outer = shop.Mix("c", "inner", 0.4f);
    ExpectShare(*outer, shop.named["c"].get(), 0.6);
    ExpectShare(*outer, shop.named["a"].get(), 0.4 * 0.6);
    ExpectShare(*outer, shop.named["b"].get(), 0.4 * 0.4);
}

TEST(MixMaterial, AmountMayBeATexture) {
    MixShop shop;
    shop.Define("u", false, "bilerp", Ramp());
    MaterialPtr mix = shop.Make("mix", Params("mix").Strings("materials", {"a", "b"}).Texture("amount", "u"));
    Rng rng(4);
    int right = 0, left = 0;
    for (int i = 0; i < 4000; ++i) {
        SurfacePoint s = RandomPoint(rng);
        bool second = mix->Resolve(s) == shop.named["b"].get();
        (s.uv.x > 0.5f ? right : left) += second;
    }
    EXPECT_NEAR(right, 1500, 150);
    EXPECT_NEAR(left, 500, 100);
}

TEST(MixMaterial, ScattersLikeTheChosenOne) {
    MixShop shop;
    MaterialPtr mix = shop.Mix("a", "b", 0.5f);
    Rng rng(6);
    for (int i = 0; i < 20; ++i) {
        SurfacePoint s = RandomPoint(rng);
        SampledWavelengths lambda = SampledWavelengths::SampleVisible(0.5f);
        ExpectSameScattering(mix->GetBsdf(s, lambda), mix->Resolve(s)->GetBsdf(s, lambda));
    }
}

TEST(MixMaterial, BadOperandsAreLocated) {
    MixShop shop;
    using Words = std::vector<std::string>;
    for (const auto &[names, words] : {std::pair(Words{"a"}, Words{}),
                                       {{"a", "b", "c"}, {}},
                                       {{"a", "absent"}, {"absent"}},
                                       {{"air", "a"}, {"interface"}}})
        ExpectErrorAt([&] { shop.Make("mix", Params("mix", 5).Strings("materials", names)); }, 6, words);
    ExpectErrorAt([&] { shop.Make("mix", Params("mix", 5)); }, 5, {});
}

TEST(MixMaterial, NestingHasALimit) {
    MixShop shop;
    shop.named["m0"] = shop.Mix("a", "b", 0.5f);
    const auto nest = [&](int depth) {
        shop.named[fmt::format("m{}", depth)] = shop.Mix(fmt::format("m{}", depth - 1), "a", 0.5f);
    };
    for (int depth = 1; depth < 256; ++depth) ASSERT_NO_THROW(nest(depth));
    ExpectErrorAt([&] { nest(256); }, 1, {"nested more than 256 deep"});
}

}  // namespace
}  // namespace pbrt::test
