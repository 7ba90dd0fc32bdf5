#include <gtest/gtest.h>

#include "material_test_support.h"
#include "support/errors.h"

namespace pbrt {
namespace {

using test::ExpectSameScattering;
using test::kLambda;
using test::Params;
using test::TestPoint;

class Hair : public testing::Test {
  protected:
    Bsdf Of(const Params &params) {
        SampledWavelengths lambda = kLambda;
        return shop_.Make("hair", params)->GetBsdf(point_, lambda);
    }
    Bsdf By(const SampledSpectrum &sigmaA, Float eta = 1.55f, Float betaM = .3f, Float betaN = .3f, Float alpha = 2) {
        return Bsdf(point_.shading.n, point_.shading.dpdu,
                    HairBxdf(2 * point_.uv.y - 1, eta, sigmaA, betaM, betaN, alpha));
    }
    static SampledSpectrum Unbounded(Float r, Float g, Float b) {
        return RgbUnboundedSpectrum(ColorSpace::SRGB(), Rgb(r, g, b)).Sample(kLambda);
    }
    static SampledSpectrum Looking(Float r, Float g, Float b, Float betaN) {
        return HairBxdf::AbsorptionOfReflectance(RgbAlbedoSpectrum(ColorSpace::SRGB(), Rgb(r, g, b)).Sample(kLambda),
                                                 betaN);
    }

    test::Workshop shop_;
    SurfacePoint point_ = TestPoint();
};

TEST_F(Hair, FourWaysToColorIt) {
    ExpectSameScattering(Of(Params("m")), By(Unbounded(1.3f * .419f, 1.3f * .697f, 1.3f * 1.37f)));
    ExpectSameScattering(Of(Params("m").F("eumelanin", .6f).F("pheomelanin", .5f)),
                         By(Unbounded(.6f * .419f + .5f * .187f, .6f * .697f + .5f * .4f, .6f * 1.37f + .5f * 1.05f)));
    ExpectSameScattering(Of(Params("m").F("pheomelanin", .5f)), By(Unbounded(.5f * .187f, .5f * .4f, .5f * 1.05f)));
    ExpectSameScattering(Of(Params("m").Rgb("sigma_a", .06f, .13f, .38f)), By(Unbounded(.06f, .13f, .38f)));
    for (const char *name : {"reflectance", "color"})
        ExpectSameScattering(Of(Params("m").Rgb(name, .6f, .4f, .2f).F("beta_n", .5f)),
                             By(Looking(.6f, .4f, .2f, .5f), 1.55f, .3f, .5f));
    EXPECT_TRUE(shop_.sink.All().empty());
}

TEST_F(Hair, ShapeOfTheFibre) {
    ExpectSameScattering(
        Of(Params("m").Rgb("sigma_a", .1f, .1f, .1f).F("eta", 1.4f).F("beta_m", .2f).F("beta_n", .4f).F("alpha", 5)),
        By(Unbounded(.1f, .1f, .1f), 1.4f, .2f, .4f, 5));
    ExpectSameScattering(Of(Params("m").Rgb("sigma_a", .1f, .1f, .1f).F("beta_m", 0).F("beta_n", 7)),
                         By(Unbounded(.1f, .1f, .1f), 1.55f, .01f, 1));
    shop_.Define("u", false, "bilerp", Params().F("v00", 0).F("v01", 0).F("v10", 1).F("v11", 1));
    ExpectSameScattering(
        Of(Params("m").Tex("eumelanin", "u").Tex("beta_m", "u")),
        By(Unbounded(.419f * point_.uv.x, .697f * point_.uv.x, 1.37f * point_.uv.x), 1.55f, point_.uv.x));
}

TEST_F(Hair, TheFirstWayCountsAndTheOthersAreWarnedOf) {
    ExpectSameScattering(Of(Params("m", 3).Rgb("sigma_a", .1f, .1f, .1f).Rgb("color", .5f, .5f, .5f).F("eumelanin", 1)),
                         By(Unbounded(.1f, .1f, .1f)));
    ASSERT_EQ(shop_.sink.All().size(), 2u);
    EXPECT_EQ(shop_.Errors(), 0u);
    test::ExpectWords(shop_.sink.All()[0].message, {"\"color\"", "\"sigma_a\""});
    test::ExpectWords(shop_.sink.All()[1].message, {"\"eumelanin\""});
    EXPECT_EQ(shop_.sink.All()[1].loc.line, 6);
}

TEST_F(Hair, TakesNoRelief) {
    shop_.Make("hair", Params("m").F("displacement", 1));
    EXPECT_EQ(shop_.Errors(), 1u);
}

}  // namespace
}  // namespace pbrt
