#include <gtest/gtest.h>

#include "material_test_support.h"

namespace pbrt::test {
namespace {

class Hair : public MaterialTest {
  protected:
    void ExpectHair(const Params &params, const SampledSpectrum &sigmaA, Float eta = 1.55f, Float betaM = .3f,
                    Float betaN = .3f, Float alpha = 2) {
        ExpectLobe("hair", params, HairBxdf(2 * point_.uv.y - 1, eta, sigmaA, betaM, betaN, alpha));
    }
};

TEST_F(Hair, FourWaysToColorIt) {
    ExpectHair(Params(), Unbounded(1.3f * .419f, 1.3f * .697f, 1.3f * 1.37f));
    ExpectHair(Params().Number("eumelanin", .6f).Number("pheomelanin", .5f),
               Unbounded(.6f * .419f + .5f * .187f, .6f * .697f + .5f * .4f, .6f * 1.37f + .5f * 1.05f));
    ExpectHair(Params().Number("pheomelanin", .5f), Unbounded(.5f * .187f, .5f * .4f, .5f * 1.05f));
    ExpectHair(Params().Rgb("sigma_a", .06f, .13f, .38f), Unbounded(.06f, .13f, .38f));
    for (const char *name : {"reflectance", "color"})
        ExpectHair(Params().Rgb(name, .6f, .4f, .2f).Number("beta_n", .5f),
                   HairBxdf::AbsorptionOfReflectance(Albedo(.6f, .4f, .2f), .5f), 1.55f, .3f, .5f);
    EXPECT_TRUE(shop_.sink.All().empty());
}

TEST_F(Hair, ShapeOfTheFibre) {
    const Params grey = Params().Rgb("sigma_a", .1f, .1f, .1f);
    ExpectHair(Params(grey).Number("eta", 1.4f).Number("beta_m", .2f).Number("beta_n", .4f).Number("alpha", 5),
               Unbounded(.1f, .1f, .1f), 1.4f, .2f, .4f, 5);
    ExpectHair(Params(grey).Number("beta_m", 0).Number("beta_n", 7), Unbounded(.1f, .1f, .1f), 1.55f, .01f, 1);
    shop_.Define("u", false, "bilerp", Ramp());
    const Float u = point_.uv.x;
    ExpectHair(Params().Texture("eumelanin", "u").Texture("beta_m", "u"), Unbounded(.419f * u, .697f * u, 1.37f * u),
               1.55f, u);
    shop_.Define("negative", false, "bilerp", Ramp(-3, -2));
    ExpectHair(Params(grey).Texture("eta", "negative"), Unbounded(.1f, .1f, .1f), 0);
}

TEST_F(Hair, TheFirstWayCountsAndTheOthersAreWarnedOf) {
    ExpectHair(Params("m", 3).Rgb("sigma_a", .1f, .1f, .1f).Rgb("color", .5f, .5f, .5f).Number("eumelanin", 1),
               Unbounded(.1f, .1f, .1f));
    ASSERT_EQ(shop_.sink.All().size(), 2u);
    ExpectWords(shop_.sink.All()[0].message, {"\"color\"", "\"sigma_a\""});
    ExpectWords(shop_.sink.All()[1].message, {"\"eumelanin\""});
    EXPECT_EQ(shop_.sink.All()[1].loc.line, 6);
}

TEST_F(Hair, TakesNoRelief) {
    shop_.Make("hair", Params().Number("displacement", 1));
    EXPECT_EQ(shop_.Errors(), 1u);
}

}  // namespace
}  // namespace pbrt::test
