#include <gtest/gtest.h>

#include "texture_test_support.h"

namespace pbrt::test {
namespace {

TEST(TextureLibrary, ValuesAndDefaults) {
    Bench b;
    EXPECT_EQ(b.GetFloat(Params().Number("roughness", 0.3f), "roughness", 1)->Constant(), 0.3f);
    EXPECT_EQ(b.GetFloat(Params(), "roughness", 0.7f)->Constant(), 0.7f);
    EXPECT_EQ(b.GetFloat(Params(), "roughness"), nullptr);
    EXPECT_EQ(b.GetSpectrum(Params(), "k", SpectrumUse::Unbounded), nullptr);
    auto s = b.GetSpectrum(Params().Spectrum("k", {300, 2, 900, 2}), "k", SpectrumUse::Unbounded);
    ASSERT_NE(s, nullptr);
    EXPECT_FLOAT_EQ((*s->Constant())(500), 2);
}

TEST(TextureLibrary, FamiliesAreSeparateNameSpaces) {
    Bench b;
    b.Define("x", false, "constant", Params().Number("value", 3));
    b.Define("x", true, "constant", Params().Rgb("value", .1f, .1f, .1f));
    EXPECT_EQ(b.FloatTex("x")->Constant(), 3);
    EXPECT_NEAR((*b.SpectrumTex("x")->Constant())(500), 0.1f, 1e-3f);
}

TEST(TextureLibrary, RedefinitionIsAnError) {
    Bench b;
    b.Define("t", false, "constant", Params("first", 4));
    ExpectErrorAt([&] { b.Define("t", false, "constant", Params("second", 9)); }, 9, {"\"t\""});
}

TEST(TextureLibrary, UnknownNameListsTheNames) {
    Bench b;
    b.Define("wood", false, "constant", Params());
    b.Define("stone", true, "constant", Params());
    ExpectErrorAt([&] { b.GetFloat(Params("m", 3).Texture("roughness", "woood"), "roughness", 0); }, 4,
                  {"did you mean \"wood\""});
    ExpectError([&] { b.GetFloat(Params("m").Texture("roughness", "stone"), "roughness", 0); },
                {"spectrum texture", "wood"});
    ExpectError([&] { b.GetSpectrum(Params("m").Texture("k", "wood"), "k", SpectrumUse::Albedo); },
                {"float texture", "stone"});
    Bench empty;
    ExpectError([&] { empty.FloatTex("a"); }, {"no float texture is defined"});
}

TEST(TextureLibrary, UnbuiltClassIsNamed) {
    Bench b;
    ExpectErrorAt([&] { b.Define("bumps", false, "ptex", Params("Texture", 6)); }, 6,
                  {"bumps", "ptex", "not supported", "imagemap"});
    // The name is defined, so a user of the texture reports no second error.
    EXPECT_NE(b.FloatTex("bumps"), nullptr);
    b.textures.CheckAll();
    EXPECT_EQ(b.Errors(), 0u);
}

TEST(TextureLibrary, UnknownClassListsTheClasses) {
    Bench b;
    ExpectError([&] { b.Define("a", true, "checkrboard", Params()); }, {"did you mean \"checkerboard\"", "marble"});
    ExpectError([&] { b.Define("b", false, "marble", Params()); }, {"float texture class \"marble\""});
}

TEST(TextureLibrary, OperandsMustComeEarlier) {
    Bench b;
    b.Define("a", true, "scale", Params("Texture \"a\"", 10).Texture("tex", "b"));
    b.Define("b", true, "scale", Params("Texture \"b\"", 20).Texture("tex", "a"));
    b.Define("self", true, "scale", Params("Texture \"self\"", 30).Texture("tex", "self"));
    b.textures.CheckAll();
    b.ExpectErrors({11, 31}, {"spectrum texture \"b\""});
}

TEST(TextureLibrary, FloatOperandsOfSpectrumTexturesMayComeLater) {
    Bench b;
    b.Define("a", true, "scale", Params("Texture \"a\"", 10).Rgb("tex", 0.5f, 0.5f, 0.5f).Texture("scale", "b"));
    b.Define("b", false, "constant", Params("Texture \"b\"", 20).Number("value", 0.25f));
    b.textures.CheckAll();
    b.ExpectErrors({});
}

TEST(TextureLibrary, ImageMapsMayComeLater) {
    Bench b;
    b.Define("a", false, "scale", Params("Texture \"a\"", 10).Texture("tex", "image"));
    b.Define("image", false, "imagemap", Params("Texture \"image\"", 20).String("filename", "/none.png"));
    b.FloatTex("a");
    b.ExpectErrors({21});  // the error is the missing image file, not a missing texture
}

TEST(TextureLibrary, UnusedTexturesAreCheckedToo) {
    Bench b;
    b.Define("t", true, "constant", Params("Texture \"t\"", 10).Rgb("value", .1f, -.2f, .3f));
    b.textures.CheckAll();
    b.ExpectErrors({11});
}

TEST(TextureLibrary, AlbedoAboveOneIsAnErrorOfTheUse) {
    Bench b;
    b.Define("t", true, "constant", Params("Texture \"t\"", 10).Rgb("value", 1, 2, 3));
    b.SpectrumTex("t", SpectrumUse::Illuminant);
    EXPECT_EQ(b.Errors(), 0u);
    b.SpectrumTex("t", SpectrumUse::Albedo);
    b.ExpectErrors({11});
}

TEST(TextureLibrary, MisspeltParameterListsTheChoices) {
    Bench b;
    b.Define("t", false, "checkerboard", Params("Texture \"t\"", 10).Number("tex1", 1).Number("uscal", 2));
    b.Define("u", false, "constant", Params("Texture \"u\"", 20).Integer("value", 2));
    b.textures.CheckAll();
    b.ExpectErrors({12, 21}, {"did you mean \"uscale\""});
}

TEST(TextureLibrary, LastOfValueAndTextureWinsAndTheOtherIsUnused) {
    Bench b;
    b.Define("half", false, "constant", Params().Number("value", 0.5f));
    Params valueLast = Params("m", 10).Texture("roughness", "half").Number("roughness", 0.2f);
    Params textureLast = Params("m", 20).Number("roughness", 0.2f).Texture("roughness", "half");
    EXPECT_EQ(b.GetFloat(valueLast, "roughness", 0)->Constant(), 0.2f);
    EXPECT_EQ(b.GetFloat(textureLast, "roughness", 0)->Constant(), 0.5f);
    b.ExpectErrors({11, 21});
}

TEST(TextureLibrary, OwnTextureBeatsAttributeValue) {
    Bench b;
    b.Define("half", false, "constant", Params().Number("value", 0.5f));
    Params own = Params("m").Texture("roughness", "half").Default(ParamType::Float, "roughness", {0.9f});
    EXPECT_EQ(b.GetFloat(own, "roughness", 0)->Constant(), 0.5f);
    Params attribute = Params("m").Default(ParamType::Float, "roughness", {0.9f});
    EXPECT_EQ(b.GetFloat(attribute, "roughness", 0)->Constant(), 0.9f);
}

TEST(TextureLibrary, TheLaterOfTwoAttributeDefaultsWins) {
    Bench b;
    b.Define("half", false, "constant", Params().Number("value", 0.5f));
    const Param texture = StringParam("roughness", "half", ParamType::Texture);
    Params textureLast = Params("m").Default(ParamType::Float, "roughness", {0.9f}).Default(texture);
    EXPECT_EQ(b.GetFloat(textureLast, "roughness", 0)->Constant(), 0.5f);
    Params valueLast = Params("m").Default(texture).Default(ParamType::Float, "roughness", {0.9f});
    EXPECT_EQ(b.GetFloat(valueLast, "roughness", 0)->Constant(), 0.9f);
}

TEST(TextureLibrary, ALongChainIsAnErrorAndNeverRecursesDeeply) {
    for (bool fromTheTop : {true, false}) {
        Bench b;
        b.Define("t0", false, "fbm", Params("t0"));
        for (int i = 1; i < 30'000; ++i)
            b.Define(fmt::format("t{}", i), false, "scale",
                     Params(fmt::format("t{}", i), i % 150)
                         .Texture("tex", fmt::format("t{}", i - 1))
                         .Texture("scale", "t0"));
        if (fromTheTop) b.FloatTex("t29999");
        b.textures.CheckAll();
        ASSERT_GE(b.Errors(), 1u);
        ExpectWords(b.sink.All()[0].message, {"nested", "256"});
        EXPECT_GT(b.sink.All()[0].loc.line, 0);
        if (!fromTheTop) {  // t0 is the first of 256
            EXPECT_EQ(b.sink.All()[0].loc.line, 256 % 150 + 1);
        }
    }
}

TEST(TextureLibrary, AsDeepAsTheLimitIsFine) {
    Bench b;
    b.Define("t1", true, "marble", Params());
    for (int i = 2; i <= 256; ++i)
        b.Define(fmt::format("t{}", i), true, "mix",
                 Params().Texture("tex1", fmt::format("t{}", i - 1)).Rgb("tex2", 0, 0, 0).Number("amount", 0.25f));
    TextureContext at;
    SampledWavelengths lambda = SampledWavelengths::SampleVisible(0.5f);
    EXPECT_GT(b.SpectrumTex("t20")->Evaluate(at, lambda)[0], 0);
    b.SpectrumTex("t256")->Evaluate(at, lambda);
    EXPECT_EQ(b.Errors(), 0u);
}

TEST(TextureLibrary, MixesOfMixesOfTheSameMustNotDoubleForEver) {
    for (const char *kind : {"mix", "checkerboard"}) {
        Bench b;
        b.Define("t0", true, "marble", Params());
        const char *second = "tex2";
        for (int i = 1; i <= 60; ++i) {
            const std::string below = fmt::format("t{}", i - 1);
            b.Define(fmt::format("t{}", i), true, kind,
                     Params("texture", i).Texture("tex1", below).Texture(second, below));
        }
        b.SpectrumTex("t60");
        ASSERT_GE(b.Errors(), 1u);
        // 2^16 - 1 evaluations are allowed, but not twice as many plus one: that is reported at the second operand of
        // the 16th texture.
        EXPECT_EQ(b.sink.All()[0].loc.line, 16 + 2) << b.sink.All()[0].message;
        ExpectWords(b.sink.All()[0].message, {"1.3e+05 textures", "65536"});
    }
}

}  // namespace
}  // namespace pbrt::test
