#include <gtest/gtest.h>

#include "pbrt/math/rng.h"
#include "pbrt/textures/texture_mapping.h"
#include "texture_test_support.h"

namespace pbrt::test {
namespace {

TextureContext PatchPoint(Float u, Float v) {
    TextureContext ctx;
    ctx.uv = {u, v};
    ctx.p = {u, v, 0};
    ctx.n = {0, 0, 1};
    return ctx;
}

const SampledWavelengths kLambda = SampledWavelengths::SampleVisible(0.3f);

SampledSpectrum Albedo(Float r, Float g, Float b) {
    return RgbAlbedoSpectrum(ColorSpace::SRGB(), Rgb(r, g, b)).Sample(kLambda);
}

TEST(ConstantTexture, IsMarkedAsConstantAndHasItsValue) {
    Bench b;
    b.Define("a", false, "constant", Params().Number("value", 0.45f));
    b.Define("d", false, "constant", Params());
    b.Define("c", true, "constant", Params().Rgb("value", .7f, .3f, .25f));
    b.Define("one", true, "constant", Params());
    EXPECT_EQ(b.FloatTex("a")->Evaluate({}), 0.45f);
    EXPECT_EQ(b.FloatTex("a")->Constant(), 0.45f);
    EXPECT_EQ(b.FloatTex("d")->Evaluate({}), 1);
    ASSERT_NE(b.SpectrumTex("c")->Constant(), nullptr);
    ExpectNear(b.SpectrumTex("c")->Evaluate({}, kLambda), Albedo(.7f, .3f, .25f), 0);
    ExpectNear(b.SpectrumTex("one")->Evaluate({}, kLambda), SampledSpectrum(1), 0);
}

TEST(ConstantTexture, IsUpliftedForItsUse) {
    Bench b;
    b.Define("c", true, "constant", Params().Rgb("value", .7f, .3f, .25f));
    const RgbUnboundedSpectrum unbounded(ColorSpace::SRGB(), {.7f, .3f, .25f});
    const RgbIlluminantSpectrum light(ColorSpace::SRGB(), {.7f, .3f, .25f});
    ExpectNear(b.SpectrumTex("c", SpectrumUse::Unbounded)->Evaluate({}, kLambda), unbounded.Sample(kLambda), 0);
    ExpectNear(b.SpectrumTex("c", SpectrumUse::Illuminant)->Evaluate({}, kLambda), light.Sample(kLambda), 0);
    EXPECT_EQ(b.SpectrumTex("c"), b.SpectrumTex("c"));
    EXPECT_NE(b.SpectrumTex("c"), b.SpectrumTex("c", SpectrumUse::Unbounded));
}

TEST(ScaleTexture, Multiplies) {
    Bench b;
    b.Define("u", false, "bilerp", Ramp());
    b.Define("c", true, "constant", Params().Rgb("value", .7f, .3f, .25f));
    b.Define("s", true, "scale", Params().Texture("tex", "c").Texture("scale", "u"));
    b.Define("k", true, "scale", Params().Rgb("tex", .2f, .4f, .6f).Number("scale", 0.5f));
    b.Define("f", false, "scale", Params().Texture("tex", "u").Number("scale", 4));
    b.Define("ff", false, "scale", Params().Number("tex", 3).Number("scale", 4));
    ExpectNear(b.SpectrumTex("s")->Evaluate(PatchPoint(0.25f, 0.9f), kLambda), Albedo(.7f, .3f, .25f) * 0.25f);
    ExpectNear(b.SpectrumTex("s")->Evaluate(PatchPoint(0, 0), kLambda), SampledSpectrum(0), 0);
    ExpectNear(b.SpectrumTex("k")->Evaluate({}, kLambda), Albedo(.2f, .4f, .6f) * 0.5f);
    EXPECT_FLOAT_EQ(b.FloatTex("f")->Evaluate(PatchPoint(0.25f, 0.5f)), 1);
    EXPECT_EQ(b.FloatTex("ff")->Constant(), 12);
}

TEST(MixTexture, BlendsFromFirstToSecond) {
    Bench b;
    b.Define("u", false, "bilerp", Ramp());
    b.Define("m", true, "mix", Params().Rgb("tex1", .1f, .6f, .5f).Rgb("tex2", .8f, .3f, .3f).Texture("amount", "u"));
    b.Define("d", false, "mix", Params());
    b.Define("first", false, "mix", Params().Number("tex1", 7).Number("amount", 0));
    SampledSpectrum a = Albedo(.1f, .6f, .5f), c = Albedo(.8f, .3f, .3f);
    ExpectNear(b.SpectrumTex("m")->Evaluate(PatchPoint(0, 0), kLambda), a, 0);
    ExpectNear(b.SpectrumTex("m")->Evaluate(PatchPoint(1, 0), kLambda), c, 0);
    ExpectNear(b.SpectrumTex("m")->Evaluate(PatchPoint(.25f, 0), kLambda), a * .75f + c * .25f);
    EXPECT_FLOAT_EQ(b.FloatTex("d")->Evaluate({}), 0.5f);
    EXPECT_EQ(b.FloatTex("first")->Constant(), 7);
}

TEST(DirectionMixTexture, FirstAlongTheDirection) {
    Bench b;
    b.Define("d", false, "directionmix", Params().Number("tex1", 8).Number("tex2", 2).Vector("dir", 0, 0, -5));
    b.Define("turned", false, "directionmix", Params().Number("tex1", 8).Number("tex2", 2),
             Transform::Rotate(90, {1, 0, 0}));
    TextureContext ctx;
    ctx.n = {0, 0, 1};
    EXPECT_FLOAT_EQ(b.FloatTex("d")->Evaluate(ctx), 8);
    EXPECT_FLOAT_EQ(b.FloatTex("turned")->Evaluate(ctx), 8);
    ctx.n = {1, 0, 0};
    EXPECT_FLOAT_EQ(b.FloatTex("d")->Evaluate(ctx), 2);
    ctx.n = {0, 0.8f, 0.6f};
    EXPECT_FLOAT_EQ(b.FloatTex("d")->Evaluate(ctx), 0.6f * 8 + 0.4f * 2);
}

TEST(BilerpTexture, CornersAreNamedBySThenT) {
    Bench b;
    b.Define("f", false, "bilerp", Params().Number("v00", 1).Number("v01", 2).Number("v10", 3).Number("v11", 4));
    b.Define("s", true, "bilerp", Params().Rgb("v00", .8f, .1f, .1f).Rgb("v10", .1f, .1f, .8f));
    auto f = b.FloatTex("f");
    EXPECT_FLOAT_EQ(f->Evaluate(PatchPoint(0, 0)), 1);
    EXPECT_FLOAT_EQ(f->Evaluate(PatchPoint(0, 1)), 2);
    EXPECT_FLOAT_EQ(f->Evaluate(PatchPoint(1, 0)), 3);
    EXPECT_FLOAT_EQ(f->Evaluate(PatchPoint(1, 1)), 4);
    EXPECT_FLOAT_EQ(f->Evaluate(PatchPoint(.5f, .25f)), .375f * 1 + .125f * 2 + .375f * 3 + .125f * 4);
    ExpectNear(b.SpectrumTex("s")->Evaluate(PatchPoint(.5f, 0), kLambda),
               (Albedo(.8f, .1f, .1f) + Albedo(.1f, .1f, .8f)) * .5f);
}

TEST(CheckerboardTexture, CellsAlternateFromTheFirstTexture) {
    Bench b;
    b.Define("c", false, "checkerboard",
             Params().Number("tex1", 5).Number("tex2", 9).Number("uscale", 2).Number("vscale", 2));
    auto value = [&](Float u, Float v) { return b.FloatTex("c")->Evaluate(PatchPoint(u, v)); };
    EXPECT_EQ(value(.1f, .1f), 5);
    EXPECT_EQ(value(.6f, .1f), 9);
    EXPECT_EQ(value(.1f, .6f), 9);
    EXPECT_EQ(value(.6f, .6f), 5);
    EXPECT_EQ(value(-.1f, .1f), 9);
    EXPECT_EQ(value(-.1f, -.1f), 5);
}

TEST(CheckerboardTexture, ThreeDimensionsUseTextureSpace) {
    Bench b;
    b.Define("c", false, "checkerboard", Params().Integer("dimension", 3), Transform::Scale({2, 2, 2}));
    auto value = [&](const Point3 &p) {
        TextureContext ctx;
        ctx.p = p;
        return b.FloatTex("c")->Evaluate(ctx);
    };
    EXPECT_EQ(value({1, 1, 1}), 1);
    EXPECT_EQ(value({3, 1, 1}), 0);
    EXPECT_EQ(value({3, 3, 1}), 1);
    EXPECT_EQ(value({3, 3, 3}), 0);
    EXPECT_EQ(value({-1, 1, 1}), 0);
}

TEST(CheckerboardTexture, OtherDimensionsAreErrors) {
    Bench b;
    b.Define("c", false, "checkerboard", Params().Integer("dimension", 4));
    b.FloatTex("c");
    b.ExpectErrors({1});
}

/// The reference: the unfiltered wave, integrated with the tent filter.
double BruteForceWave(double x, double radius) {
    double sum = 0, weights = 0;
    constexpr int kSteps = 20000;
    for (int i = 0; i < kSteps; ++i) {
        double o = (2 * (i + 0.5) / kSteps - 1) * radius, w = radius - std::abs(o);
        double m = (x + o) - 2 * std::floor((x + o) / 2);
        sum += w * (m < 1 ? 1 : -1);
        weights += w;
    }
    return sum / weights;
}

TEST(CheckerboardTexture, FilteredWaveEqualsSupersampledWave) {
    Rng rng(3);
    for (int i = 0; i < 200; ++i) {
        Float x = 20 * rng.Uniform() - 10, radius = 0.02f + 3 * Sqr(rng.Uniform());
        EXPECT_NEAR(FilteredSquareWave(x, radius), BruteForceWave(x, radius), 2e-3) << x << " " << radius;
    }
    EXPECT_EQ(FilteredSquareWave(0.5f, 0), 1);
    EXPECT_EQ(FilteredSquareWave(1.5f, 0), -1);
}

TEST(CheckerboardTexture, FilterCoversOneAndAHalfSteps) {
    Bench b;
    b.Define("c", false, "checkerboard", Params().Number("tex1", 0).Number("tex2", 1).Number("uscale", 3));
    TextureContext ctx = PatchPoint(0.29f, 1.95f);
    ctx.dudx = 0.02f, ctx.dudy = -0.1f, ctx.dvdx = 0.3f, ctx.dvdy = 0.1f;
    double expected = 0.5 - BruteForceWave(3 * 0.29, 1.5 * 0.3) * BruteForceWave(1.95, 1.5 * 0.3) / 2;
    EXPECT_NEAR(b.FloatTex("c")->Evaluate(ctx), expected, 2e-3);
}

TEST(CheckerboardTexture, WideFootprintsGiveTheMean) {
    Bench b;
    b.Define("c", false, "checkerboard", Params());
    TextureContext ctx = PatchPoint(0.3f, 0.3f);
    ctx.dudx = ctx.dvdy = 100;
    EXPECT_NEAR(b.FloatTex("c")->Evaluate(ctx), 0.5f, 1e-3);
}

}  // namespace
}  // namespace pbrt::test
