#include <gtest/gtest.h>

#include "support/errors.h"
#include "support/folder_test.h"
#include "texture_test_support.h"

namespace pbrt {
namespace {

using test::Bench;
using test::ExpectNear;
using test::Params;

const SampledWavelengths kImageLambda = SampledWavelengths::SampleVisible(0.7f);

TextureContext AtUv(Float u, Float v) {
    TextureContext ctx;
    ctx.uv = {u, v};
    return ctx;
}

/// A folder with images of 2 x 2 pixels.
class ImageTexture : public test::FolderTest {
  protected:
    void SetUp() override {
        // Colours: red and green in the top row, blue and grey in the bottom row. Greys: 0.1 and 0.2 in the top row,
        // 0.3 and 0.4 in the bottom row.
        Write("color.pfm", "PF", {0, 0, 1, .5f, .5f, .5f, 1, 0, 0, 0, 1, 0});
        Write("grey.pfm", "Pf", {.3f, .4f, .1f, .2f});
        Write("bright.pfm", "PF", {3, .25f, .5f, 3, .25f, .5f, 3, .25f, .5f, 3, .25f, .5f});
    }

  private:
    /// Writes a PFM file, which stores the bottom row first.
    void Write(const std::string &name, const char *kind, const std::vector<float> &values) {
        const std::string bytes(reinterpret_cast<const char *>(values.data()), values.size() * sizeof(float));
        FolderTest::Write(name, std::string(kind) + "\n2 2\n-1.0\n" + bytes);
    }
};

TEST_F(ImageTexture, ZeroVIsTheBottomRow) {
    Bench b;
    b.Define("t", false, "imagemap", Params().S("filename", {Path("grey.pfm")}));
    auto t = b.FloatTex("t");
    EXPECT_FLOAT_EQ(t->Evaluate(AtUv(.25f, .25f)), .3f);
    EXPECT_FLOAT_EQ(t->Evaluate(AtUv(.75f, .25f)), .4f);
    EXPECT_FLOAT_EQ(t->Evaluate(AtUv(.25f, .75f)), .1f);
    EXPECT_FLOAT_EQ(t->Evaluate(AtUv(1.75f, .75f)), .2f);
}

TEST_F(ImageTexture, ScaleComesBeforeInversion) {
    Bench b;
    auto file = [&] { return Params().S("filename", {Path("grey.pfm")}); };
    b.Define("scaled", false, "imagemap", file().F("scale", 2));
    b.Define("inverted", false, "imagemap", file().F("scale", 3).B("invert", true));
    b.Define("again", false, "scale", Params().Tex("tex", "inverted").F("scale", 0.5f));
    EXPECT_FLOAT_EQ(b.FloatTex("scaled")->Evaluate(AtUv(.25f, .25f)), .6f);
    EXPECT_FLOAT_EQ(b.FloatTex("inverted")->Evaluate(AtUv(.25f, .75f)), .7f);
    EXPECT_EQ(b.FloatTex("inverted")->Evaluate(AtUv(.75f, .25f)), 0);
    // As in stock pbrt-v4, the factor of a scale texture is multiplied into that of the image.
    EXPECT_FLOAT_EQ(b.FloatTex("again")->Evaluate(AtUv(.25f, .75f)), 1 - 1.5f * .1f);
}

TEST_F(ImageTexture, ColorsAreUpliftedForTheirUse) {
    Bench b;
    b.Define("t", true, "imagemap", Params().S("filename", {Path("bright.pfm")}).F("scale", 0.5f));
    const ColorSpace &cs = ColorSpace::SRGB();
    Rgb rgb(1.5f, .125f, .25f);
    ExpectNear(b.SpectrumTex("t")->Evaluate(AtUv(.5f, .5f), kImageLambda),
               RgbAlbedoSpectrum(cs, glm::min(rgb, Rgb(1))).Sample(kImageLambda));
    ExpectNear(b.SpectrumTex("t", SpectrumUse::Unbounded)->Evaluate(AtUv(.5f, .5f), kImageLambda),
               RgbUnboundedSpectrum(cs, rgb).Sample(kImageLambda));
    ExpectNear(b.SpectrumTex("t", SpectrumUse::Illuminant)->Evaluate(AtUv(.5f, .5f), kImageLambda),
               RgbIlluminantSpectrum(cs, rgb).Sample(kImageLambda));
}

TEST_F(ImageTexture, ColorFollowsTheTexel) {
    Bench b;
    b.Define("t", true, "imagemap", Params().S("filename", {Path("color.pfm")}).S("filter", {"point"}));
    b.Define("i", true, "imagemap", Params().S("filename", {Path("color.pfm")}).B("invert", true));
    const ColorSpace &cs = ColorSpace::SRGB();
    auto albedo = [&](Float r, Float g, Float bl) { return RgbAlbedoSpectrum(cs, Rgb(r, g, bl)).Sample(kImageLambda); };
    ExpectNear(b.SpectrumTex("t")->Evaluate(AtUv(.25f, .75f), kImageLambda), albedo(1, 0, 0));
    ExpectNear(b.SpectrumTex("t")->Evaluate(AtUv(.75f, .75f), kImageLambda), albedo(0, 1, 0));
    ExpectNear(b.SpectrumTex("t")->Evaluate(AtUv(.25f, .25f), kImageLambda), albedo(0, 0, 1));
    ExpectNear(b.SpectrumTex("i")->Evaluate(AtUv(.25f, .75f), kImageLambda), albedo(0, 1, 1));
}

TEST_F(ImageTexture, WrapBlackAndClampReachBeyondTheImage) {
    Bench b;
    b.Define("black", false, "imagemap", Params().S("filename", {Path("grey.pfm")}).S("wrap", {"black"}));
    b.Define("clamp", false, "imagemap", Params().S("filename", {Path("grey.pfm")}).S("wrap", {"clamp"}));
    EXPECT_EQ(b.FloatTex("black")->Evaluate(AtUv(1.75f, .75f)), 0);
    EXPECT_FLOAT_EQ(b.FloatTex("clamp")->Evaluate(AtUv(1.75f, 1.75f)), .2f);
}

TEST_F(ImageTexture, FootprintReachesTheFilter) {
    Bench b;
    b.Define("t", false, "imagemap", Params().S("filename", {Path("grey.pfm")}).S("filter", {"trilinear"}));
    TextureContext ctx = AtUv(.25f, .25f);
    ctx.dudx = ctx.dvdy = 10;
    EXPECT_NEAR(b.FloatTex("t")->Evaluate(ctx), .25f, 1e-4f);
}

TEST_F(ImageTexture, MissingFileIsReportedOnceAndCounted) {
    Bench b;
    b.Define("t", true, "imagemap", Params("Texture \"t\"", 5).F("scale", 1).S("filename", {Path("none.png")}));
    b.SpectrumTex("t");
    b.SpectrumTex("t", SpectrumUse::Unbounded);
    ASSERT_EQ(b.Errors(), 1u);
    EXPECT_EQ(b.Last().loc.line, 7);
    test::ExpectWords(b.Last().message, {"file not found"});
    EXPECT_EQ(b.textures.MissingImages(), 1u);
    b.textures.CheckAll();
    test::ExpectWords(b.Last().message, {"1 missing texture"});
}

TEST_F(ImageTexture, ANameThatNoFileCanHaveIsAMissingFile) {
    Bench b;
    b.Define("t", true, "imagemap", Params("Texture \"t\"", 5).F("scale", 1).S("filename", {std::string(5000, 'x')}));
    b.SpectrumTex("t");
    ASSERT_EQ(b.Errors(), 1u);
    EXPECT_EQ(b.Last().loc.line, 7);
    test::ExpectWords(b.Last().message, {"file not found"});
}

TEST_F(ImageTexture, UnreadableFileIsLocated) {
    std::ofstream(Path("broken.png")) << "no image";
    Bench b;
    b.Define("t", false, "imagemap", Params().S("filename", {Path("broken.png")}));
    b.FloatTex("t");
    ASSERT_EQ(b.Errors(), 1u);
    EXPECT_EQ(b.Last().loc.line, 2);
    EXPECT_EQ(b.textures.MissingImages(), 0u);
}

TEST_F(ImageTexture, UnknownChoicesAreErrors) {
    for (const char *name : {"filter", "wrap", "encoding"}) {
        Bench b;
        b.Define("t", false, "imagemap", Params().S("filename", {Path("grey.pfm")}).S(name, {"nonsense"}));
        b.FloatTex("t");
        ASSERT_EQ(b.Errors(), 1u) << name;
        EXPECT_EQ(b.Last().loc.line, 3) << name;
        EXPECT_NE(b.Last().message.find("valid:"), std::string::npos) << name;
    }
    Bench b;
    b.Define("t", false, "imagemap", Params("Texture", 4));
    b.FloatTex("t");
    EXPECT_EQ(b.Last().loc.line, 4);
}

TEST_F(ImageTexture, ManyImagesKeepTheirOwnContentAndErrors) {
    Bench b;
    std::ofstream(Path("broken.pfm")) << "no image";
    for (const char *name : {"grey.pfm", "color.pfm", "none.pfm", "broken.pfm", "bright.pfm"})
        b.Define(name, false, "imagemap", Params(name).S("filename", {Path(name)}).S("filter", {"point"}));
    b.Define("later", false, "constant", Params());
    EXPECT_FLOAT_EQ(b.FloatTex("grey.pfm")->Evaluate(AtUv(.25f, .25f)), .3f);
    EXPECT_EQ(b.Errors(), 0u);
    b.Define("late.pfm", false, "imagemap", Params().S("filename", {Path("grey.pfm")}).S("wrap", {"clamp"}));
    EXPECT_FLOAT_EQ(b.FloatTex("late.pfm")->Evaluate(AtUv(.75f, .75f)), .2f);
    EXPECT_FLOAT_EQ(b.FloatTex("bright.pfm")->Evaluate(AtUv(.75f, .75f)), 3);
    b.textures.CheckAll();
    EXPECT_EQ(b.Errors(), 3u);  // missing, broken, and the count of the missing
}

TEST_F(ImageTexture, BytesAreDecodedAsTheParameterSays) {
    const Float stored = 128.f / 255;
    Image grey(PixelFormat::Float, {2, 2}, {"Y"});
    for (int i = 0; i < 4; ++i) grey.Set({i & 1, i >> 1}, 0, ColorEncoding{}.ToLinear(stored));
    WriteImage(Path("grey.png"), grey);
    auto value = [&](Params params) {
        Bench b;
        b.Define("t", false, "imagemap", params.S("filename", {Path("grey.png")}));
        return b.FloatTex("t")->Evaluate(AtUv(.5f, .5f));
    };
    EXPECT_NEAR(value(Params()), ColorEncoding{}.ToLinear(stored), 1e-3f);
    EXPECT_NEAR(value(Params().S("encoding", {"sRGB"})), ColorEncoding{}.ToLinear(stored), 1e-3f);
    EXPECT_NEAR(value(Params().S("encoding", {"linear"})), stored, 1e-3f);
    EXPECT_NEAR(value(Params().S("encoding", {"gamma 2"})), Sqr(stored), 1e-3f);
}

}  // namespace
}  // namespace pbrt
