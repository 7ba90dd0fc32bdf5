#include <gtest/gtest.h>

#include "support/folder_test.h"
#include "texture_test_support.h"

namespace pbrt::test {
namespace {

const SampledWavelengths kImageLambda = SampledWavelengths::SampleVisible(0.7f);

TextureContext AtUv(Float u, Float v) {
    TextureContext ctx;
    ctx.uv = {u, v};
    return ctx;
}

/// A folder with images of 2 x 2 pixels.
class ImageTexture : public FolderTest, protected Bench {
  protected:
    void SetUp() override {
        // Colours: red and green in the top row, blue and grey in the bottom row. Greys: 0.1 and 0.2 in the top row,
        // 0.3 and 0.4 in the bottom row.
        WritePfm("color", "PF", {0, 0, 1, .5f, .5f, .5f, 1, 0, 0, 0, 1, 0});
        WritePfm("grey", "Pf", {.3f, .4f, .1f, .2f});
        WritePfm("bright", "PF", {3, .25f, .5f, 3, .25f, .5f, 3, .25f, .5f, 3, .25f, .5f});
    }
    Params File(const std::string &name) const { return Params().String("filename", Path(name + ".pfm")); }
    void DefineImage(const std::string &name, const Params &params, bool isSpectrum = false) {
        Define(name, isSpectrum, "imagemap", params);
    }
    Float FloatAt(const std::string &name, Float u, Float v) { return FloatTex(name)->Evaluate(AtUv(u, v)); }
    /// Expects the spectrum of this kind.
    template <class Uplifted = RgbAlbedoSpectrum>
    void ExpectColor(const std::string &name, Float u, Float v, const Rgb &rgb, SpectrumUse use = SpectrumUse::Albedo) {
        ExpectNear(SpectrumTex(name, use)->Evaluate(AtUv(u, v), kImageLambda),
                   Uplifted(ColorSpace::SRGB(), rgb).Sample(kImageLambda));
    }

  private:
    /// Writes a PFM file, which stores the bottom row first.
    void WritePfm(const std::string &name, const char *kind, const std::vector<float> &values) {
        const std::string bytes(reinterpret_cast<const char *>(values.data()), values.size() * sizeof(float));
        Write(name + ".pfm", std::string(kind) + "\n2 2\n-1.0\n" + bytes);
    }
};

TEST_F(ImageTexture, ZeroVIsTheBottomRow) {
    DefineImage("t", File("grey"));
    EXPECT_FLOAT_EQ(FloatAt("t", .25f, .25f), .3f);
    EXPECT_FLOAT_EQ(FloatAt("t", .75f, .25f), .4f);
    EXPECT_FLOAT_EQ(FloatAt("t", .25f, .75f), .1f);
    EXPECT_FLOAT_EQ(FloatAt("t", 1.75f, .75f), .2f);
}

TEST_F(ImageTexture, ScaleComesBeforeInversion) {
    DefineImage("scaled", File("grey").Number("scale", 2));
    DefineImage("inverted", File("grey").Number("scale", 3).Bool("invert", true));
    Define("again", false, "scale", Params().Texture("tex", "inverted").Number("scale", 0.5f));
    EXPECT_FLOAT_EQ(FloatAt("scaled", .25f, .25f), .6f);
    EXPECT_FLOAT_EQ(FloatAt("inverted", .25f, .75f), .7f);
    EXPECT_EQ(FloatAt("inverted", .75f, .25f), 0);
    // As in stock pbrt-v4, the factor of a scale texture is multiplied into that of the image.
    EXPECT_FLOAT_EQ(FloatAt("again", .25f, .75f), 1 - 1.5f * .1f);
}

TEST_F(ImageTexture, ColorsAreUpliftedForTheirUse) {
    DefineImage("t", File("bright").Number("scale", 0.5f), true);
    ExpectColor("t", .5f, .5f, {1, .125f, .25f});  // clamped
    ExpectColor<RgbUnboundedSpectrum>("t", .5f, .5f, {1.5f, .125f, .25f}, SpectrumUse::Unbounded);
    ExpectColor<RgbIlluminantSpectrum>("t", .5f, .5f, {1.5f, .125f, .25f}, SpectrumUse::Illuminant);
}

TEST_F(ImageTexture, ColorFollowsTheTexel) {
    DefineImage("t", File("color").String("filter", "point"), true);
    DefineImage("i", File("color").Bool("invert", true), true);
    ExpectColor("t", .25f, .75f, {1, 0, 0});
    ExpectColor("t", .75f, .75f, {0, 1, 0});
    ExpectColor("t", .25f, .25f, {0, 0, 1});
    ExpectColor("i", .25f, .75f, {0, 1, 1});
}

TEST_F(ImageTexture, WrapBlackAndClampReachBeyondTheImage) {
    for (const char *wrap : {"black", "clamp"}) DefineImage(wrap, File("grey").String("wrap", wrap));
    EXPECT_EQ(FloatAt("black", 1.75f, .75f), 0);
    EXPECT_FLOAT_EQ(FloatAt("clamp", 1.75f, 1.75f), .2f);
}

TEST_F(ImageTexture, FootprintReachesTheFilter) {
    DefineImage("t", File("grey").String("filter", "trilinear"));
    TextureContext ctx = AtUv(.25f, .25f);
    ctx.dudx = ctx.dvdy = 10;
    EXPECT_NEAR(FloatTex("t")->Evaluate(ctx), .25f, 1e-4f);
}

/// The second name is one that no file can have.
TEST_F(ImageTexture, MissingFilesAreReportedOnceAndCounted) {
    for (const std::string &file : {std::string("none.png"), std::string(5000, 'x')}) {
        Bench b;
        b.Define("t", true, "imagemap", Params("Texture \"t\"", 5).Number("scale", 1).String("filename", Path(file)));
        b.SpectrumTex("t");
        b.SpectrumTex("t", SpectrumUse::Unbounded);
        b.ExpectErrors({7}, {"file not found"});
        b.textures.CheckAll();
        ExpectWords(b.Last().message, {"1 missing texture"});
    }
}

TEST_F(ImageTexture, UnreadableFileIsLocated) {
    Write("broken.pfm", "no image");
    DefineImage("t", File("broken"));
    FloatTex("t");
    ExpectErrors({1});
    textures.CheckAll();
    ExpectErrors({1});
}

TEST_F(ImageTexture, UnknownChoicesAreErrors) {
    for (const char *name : {"filter", "wrap", "encoding"}) {
        SCOPED_TRACE(name);
        Bench b;
        b.Define("t", false, "imagemap", File("grey").String(name, "nonsense"));
        b.FloatTex("t");
        b.ExpectErrors({2}, {"valid:"});
    }
    DefineImage("t", Params("Texture", 4));
    FloatTex("t");
    ExpectErrors({4});
}

TEST_F(ImageTexture, ManyImagesKeepTheirOwnContentAndErrors) {
    Write("broken.pfm", "no image");
    for (const char *name : {"grey", "color", "none", "broken", "bright"})
        DefineImage(name, File(name).String("filter", "point"));
    Define("later", false, "constant", Params());
    EXPECT_FLOAT_EQ(FloatAt("grey", .25f, .25f), .3f);
    EXPECT_EQ(Errors(), 0u);
    DefineImage("late", File("grey").String("wrap", "clamp"));
    EXPECT_FLOAT_EQ(FloatAt("late", .75f, .75f), .2f);
    EXPECT_FLOAT_EQ(FloatAt("bright", .75f, .75f), 3);
    textures.CheckAll();
    EXPECT_EQ(Errors(), 3u);  // missing, broken, and the count of the missing
}

TEST_F(ImageTexture, BytesAreDecodedByTheirParameter) {
    const Float stored = 128.f / 255;
    Image grey(PixelFormat::Float, {2, 2}, {"Y"});
    for (int i = 0; i < 4; ++i) grey.Set({i & 1, i >> 1}, 0, ColorEncoding{}.ToLinear(stored));
    WriteImage(Path("grey.png"), grey);
    for (auto [encoding, expected] : {std::pair("", ColorEncoding{}.ToLinear(stored)),
                                      {"sRGB", ColorEncoding{}.ToLinear(stored)},
                                      {"linear", stored},
                                      {"gamma 2", Sqr(stored)}}) {
        Params params = Params().String("filename", Path("grey.png"));
        if (*encoding) params.String("encoding", encoding);
        DefineImage(std::string("t") + encoding, params);
        EXPECT_NEAR(FloatAt(std::string("t") + encoding, .5f, .5f), expected, 1e-3f) << encoding;
    }
}

}  // namespace
}  // namespace pbrt::test
