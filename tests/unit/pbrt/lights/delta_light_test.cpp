#include "light_test_support.h"
#include "pbrt/lights/infinite_lights.h"
#include "pbrt/lights/point_lights.h"

namespace pbrt::test {
namespace {

TEST(PointLight, ScaleOneOfTheIlluminantIsOneCandelaAndRgbScalesIt) {
    EXPECT_NEAR(Lux(*Make("point", Params().Point("from", {1, 2, 3})), {1, 2, 5}), 0.25, 1e-3);
    EXPECT_NEAR(Lux(*Make("point", Params().Rgb("I", 3, 3, 3).Number("scale", 2)), {0, 0, 1}), 6, 0.02);
}

TEST(PointLight, TransformMovesIt) {
    auto light =
        Make("point", Params().Point("from", {1, 0, 0}), Transform::Translate({0, 5, 0}) * Transform::Scale({2, 2, 2}));
    auto s = light->SampleLi(At({2, 0, 0}), {}, kLambda, false);
    ASSERT_TRUE(s);
    EXPECT_NEAR(Distance(s->pLight, {2, 5, 0}), 0, 1e-6);
    EXPECT_NEAR(s->wi.y, 1, 1e-6);
    EXPECT_EQ(s->pdf, 1);
    EXPECT_FALSE(light->SampleLi(At({2, 5, 0}), {}, kLambda, false))
        << "a point at the position of the light must get no sample";
}

TEST(DeltaLights, PowerParameterIsTheFlux) {
    EXPECT_NEAR(Lumens(*Make("point", Params().Number("power", 30).Number("scale", 1))), 30, 0.05);
    EXPECT_NEAR(Lumens(*Make("spot", Cone(40, 20).Number("power", 14))), 14, 0.03);
}

TEST(SpotLight, FallsOffSmoothlyInTheCosine) {
    auto light = Make("spot", Cone(60, 30).Point("from", {0, 0, 1}).Point("to", {0, 0, 2}));
    auto &spot = dynamic_cast<SpotLight &>(*light);
    Float start = std::cos(Radians(30)), end = std::cos(Radians(60));
    auto at = [&](Float c) { return spot.Falloff(SphericalDirection(SafeSqrt(1 - c * c), c, 0.7f)); };
    EXPECT_EQ(at(1), 1);
    EXPECT_NEAR(at(start + 1e-3f), 1, 1e-5);
    EXPECT_NEAR(at((start + end) / 2), 0.5, 1e-4);
    Float t = 0.25f;
    EXPECT_NEAR(at(end + t * (start - end)), 3 * t * t - 2 * t * t * t, 1e-4);
    EXPECT_EQ(at(end - 1e-3f), 0);
    EXPECT_EQ(at(-1), 0);
}

TEST(SpotLight, ConeTurnsWithTheTransform) {
    auto light = Make("spot", Params(), Transform::Rotate(90, {0, 1, 0}));  // turns +z to +x
    EXPECT_TRUE(light->SampleLi(At({3, 0.1f, 0}), {}, kLambda, false));
    EXPECT_FALSE(light->SampleLi(At({0, 0.1f, 3}), {}, kLambda, false));
}

TEST(DistantLight, IlluminanceFallsOnAFacingSurface) {
    auto light = Make("distant", Params()
                                     .Number("illuminance", 0.9f)
                                     .Floats(ParamType::Blackbody, "L", {4500})
                                     .Point("from", {0, 2, 0})
                                     .Point("to", {0, 0, 0}));
    light->Preprocess({0, 0, 0}, 10);
    auto s = light->SampleLi(At({1, 1, 1}), {}, kLambda, false);
    ASSERT_TRUE(s);
    EXPECT_EQ(s->wi, Vector3(0, 1, 0));
    EXPECT_EQ(light->Kind(), LightKind::DeltaDirection);
    EXPECT_GE(Distance(s->pLight, {0, 0, 0}), 10) << "the shadow segment must leave the scene";
    const double lux = Lux(*light, {0, 0, 0});
    EXPECT_NEAR(lux, 0.9, 2e-3);
    const double phi = Lumens(*light);
    EXPECT_NEAR(phi, lux * std::numbers::pi * 100, 1e-2 * phi);
    EXPECT_FALSE(light->Bounds());
}

/// The importance must be positive wherever a light contributes.
TEST(LightImportance, PositiveWhereDeltaLightsContribute) {
    Rng rng(1);
    int lit = 0;
    for (int i = 0; i < 300; ++i) {
        const Float cone = 1 + 150 * rng.Uniform(), edge = i % 3 ? (i % 2 ? 2 : 1) * cone * rng.Uniform() : 0;
        const Transform ctm = RandomPlace(rng, i);
        auto light = i % 5 ? Make("spot", Cone(cone, edge), ctm) : Make("point", Params(), ctm);
        LightBounds bounds = *light->Bounds();
        for (int j = 0; j < 1000; ++j) {
            Point3 p = bounds.bounds.low + SampleUniformSphere(rng.Uniform2()) * (10 * rng.Uniform());
            lit += ExpectImportantIfLit(*light, bounds, p, rng);
        }
    }
    EXPECT_GT(lit, 10000);
}

}  // namespace
}  // namespace pbrt::test
