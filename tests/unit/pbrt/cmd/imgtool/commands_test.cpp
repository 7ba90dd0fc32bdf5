// Tests the commands that make images from images.
#include <cmath>

#include "imgtool_program.h"
#include "pbrt/math/warps.h"
#include "support/small_files.h"

namespace pbrt {

namespace {

double Sum(const Image &image, int channel) {
    double sum = 0;
    ForEachPixel(image, [&](Point2i p) { sum += double(image.Get(p, channel)); });
    return sum;
}

}  // namespace

TEST_F(Imgtool, ErrorIsTheMeanOverAllFilesWithThePrefix) {
    for (auto [name, value] : {std::pair("run1.exr", 3.f), std::pair("run2.exr", 4.f), std::pair("runref.exr", 2.f)})
        WriteImage(Path(name), Constant({4, 3}, value));
    const Outcome o = Run("error run --reference runref.exr --errorfile rune.exr");
    EXPECT_EQ(o.status, 0) << o.err;
    EXPECT_TRUE(Has(o.out, "run1.exr: 1\nrun2.exr: 4\nMSE: mean 2.5, standard deviation 2.12, 2 images")) << o.out;
    const Image errors = ReadImage(Path("rune.exr")).image;
    EXPECT_EQ(errors.Get({3, 2}, 1), 2.5f);
    EXPECT_TRUE(Has(Run("error run --reference runref.exr --errorfile rune.exr --metric MAE --crop 0,2,0,2").out,
                    "MAE: mean 1.5,"));
    EXPECT_EQ(ReadImage(Path("rune.exr")).image.Resolution(), Point2i(2, 2));
    WriteImage(Path("other.exr"), Constant({3, 3}, 1));
    ExpectErrors({{"error other --reference runref.exr", "3 x 3"},
                  {"error none --reference runref.exr", "\"none\""},
                  {"error run", "--reference"}});
}

TEST_F(Imgtool, ErrorTakesNamesAndPatternsAndListsTheFiles) {
    for (auto [name, value] : {std::pair("run1.exr", 3.f), std::pair("run10.exr", 4.f),
                               std::pair("run1.exr.old.exr", 5.f), std::pair("ref.exr", 2.f)})
        WriteImage(Path(name), Constant({4, 3}, value));
    std::ofstream(Path("run1.log")) << "no image";
    auto compared = [&](const std::string &names) { return Run("error " + names + " --reference ref.exr").out; };
    EXPECT_EQ(compared("run1.exr"), "MSE: mean 1, run1.exr\n");
    EXPECT_EQ(compared("'run1?.exr'"), "MSE: mean 4, run10.exr\n");
    EXPECT_EQ(compared("'run*0.exr' run1.exr run1.exr"),
              "run10.exr: 4\nrun1.exr: 1\nMSE: mean 2.5, standard deviation 2.12, 2 images\n");
    // A prefix of names finds images only.
    EXPECT_TRUE(Has(compared("run1"), "run1.exr: 1\nrun1.exr.old.exr: 9\nrun10.exr: 4\n")) << compared("run1");
    EXPECT_TRUE(
        Has(Run("average 'run1*.exr' --outfile mean.exr").out, "3 images: run1.exr, run1.exr.old.exr, run10.exr"));
    // A shell passes the names that fit its pattern, among them that of the reference or the last result.
    EXPECT_EQ(compared("ref.exr run1.exr ./ref.exr"), "MSE: mean 1, run1.exr\n");
    EXPECT_TRUE(
        Has(Run("average mean.exr run1.exr run10.exr --outfile mean.exr").out, "2 images: run1.exr, run10.exr"));
    ExpectErrors({{"error 'x*' --reference ref.exr", "No file fits \"x*\""},
                  {"error run1.exr x --reference ref.exr", "\"x\""},
                  {"error ref.exr --reference ref.exr", "no image but ref.exr"},
                  {"convert run1.exr twice.exr --channels R,G,R", "twice.exr: channel \"R\" is given twice"}});
}

TEST_F(Imgtool, AFullDiskIsAnErrorAndKeepsTheOldFile) {
    Write("big.exr", 64, 64, kRgb, -30);
    Write("big2.exr", 64, 64, kRgb, -31);
    WriteImage(Path("noise.exr"), Constant({64, 64}, 0.3f));
    const std::string old = Read("noise.exr");
    for (const std::string command :
         {"convert big.exr out.exr", "convert big.exr out.pfm", "convert big.exr --repeatpix 9 out.png",
          "convert big.exr --repeatpix 9 out.jpg", "average big.exr big2.exr --outfile out.pfm",
          "diff big.exr --reference noise.exr --outfile out.pfm",
          "error big.exr --reference noise.exr --errorfile out.pfm", "bloom big.exr out.pfm",
          "splitn big.exr big2.exr --outfile out.pfm", "assemble big.exr --outfile out.exr",
          "makesky --resolution 128 --outfile out.exr"}) {
        const std::string name = command.substr(command.rfind(' ') + 1);
        Write(name, old);
        {
            const test::SmallFilesOnly limit(1000);
            ExpectErrors({{command, name + ": cannot be written: File too large"}});
        }
        EXPECT_EQ(Read(name), old) << command;
        std::filesystem::remove(Path(name));
    }
}

TEST_F(Imgtool, OutputGoesThroughLinksAndPipes) {
    Write("a.exr", 4, 3, kRgb);
    std::filesystem::create_symlink("real.png", Path("link.png"));
    EXPECT_EQ(Run("convert a.exr link.png").status, 0);
    EXPECT_TRUE(std::filesystem::is_symlink(Path("link.png")));
    EXPECT_TRUE(std::filesystem::is_regular_file(Path("real.png")));
    EXPECT_EQ(Run("convert a.exr b.pfm").status, 0);
    std::filesystem::create_symlink("/dev/stdout", Path("stdout.pfm"));
    EXPECT_EQ(Run("convert a.exr stdout.pfm").out, Read("b.pfm"));
    EXPECT_EQ(Run("convert a.exr stdout.pfm | cat").out, Read("b.pfm"));
    std::filesystem::create_symlink("/dev/full", Path("full.png"));
    ExpectErrors({{"convert a.exr full.png", "full.png: cannot be written: No space left"}});
}

TEST_F(Imgtool, AssembleUndoesCrops) {
    const Image image = Write("a.exr", 6, 5, kRgb);
    for (const char *crop : {"0,2,0,5 --outfile left.exr", "2,6,0,3 --outfile top.exr", "2,6,3,5 --outfile low.exr"})
        RunWell(std::string("convert a.exr --crop ") + crop);
    EXPECT_EQ(RunWell("assemble left.exr low.exr top.exr --outfile b.exr"), "");
    EXPECT_EQ(Run("diff a.exr --reference b.exr").status, 0);
    const ImageFile joined = ReadImage(Path("b.exr"));
    EXPECT_EQ(joined.metadata.pixelBounds, (Bounds2i{{0, 0}, {6, 5}}));
    EXPECT_TRUE(Has(Run("assemble left.exr top.exr --outfile c.exr").err, "8 of 30 pixels"));
    EXPECT_EQ(ReadImage(Path("c.exr")).image.Get({5, 4}, 0), 0);
    EXPECT_TRUE(Has(Run("assemble a.exr top.exr --outfile c.exr").err, "12 pixels in more than one"));
    Write("small.exr", 4, 4, kRgb);
    Write("grey.exr", 6, 5, {"Y"});
    WriteImage(Path("a.png"), Constant({6, 5}, 1));
    ExpectErrors({{"assemble left.exr small.exr --outfile c.exr", "4 x 4"},
                  {"assemble left.exr grey.exr --outfile c.exr", "channels"},
                  {"assemble a.png --outfile c.exr", "a.png"},
                  {"assemble --outfile c.exr", "files"}});
}

TEST_F(Imgtool, SplitnShowsStripsAndEnlargedCrops) {
    // The red channel gives the number of the image, green and blue the pixel.
    for (int i = 0; i < 3; ++i)
        WriteImage(Path(fmt::format("i{}.exr", i)), RgbImage({48, 12}, [i](int x, int y) { return Rgb(i, x, y); }));
    const Image s = Written("splitn i0.exr i1.exr i2.exr --crop 3,5 --crop 7,1 --cropsize 6 --outfile s.exr").image;
    // (48 - 2 gaps of 4) / (3 * 6) = 2, so crops are enlarged twice; a row is 12 pixels and a gap of 4 high.
    ASSERT_EQ(s.Resolution(), Point2i(48, 12 + 2 * 16));
    EXPECT_EQ(RgbAt(s, {0, 0}), Rgb(0, 0, 0));
    EXPECT_EQ(RgbAt(s, {20, 11}), Rgb(1, 20, 11));
    EXPECT_EQ(RgbAt(s, {47, 5}), Rgb(2, 47, 5));
    EXPECT_EQ(RgbAt(s, {15, 3}), Rgb(1)) << "there must be a white line between the strips";
    EXPECT_EQ(RgbAt(s, {0, 16}), Rgb(0, 3, 5));
    EXPECT_EQ(RgbAt(s, {16 + 3, 16 + 11}), Rgb(1, 4, 10));
    EXPECT_EQ(RgbAt(s, {2 * 16 + 2, 2 * 16 + 5}), Rgb(2, 8, 3));
    EXPECT_EQ(s.Get({13, 18}, 0), 1) << "gap";
    ExpectErrors({{"splitn i0.exr --outfile s.exr", "two"},
                  {"splitn i0.exr i1.exr --cropsize 6 --outfile s.exr", "--crop"},
                  {"splitn i0.exr i1.exr --crop 3 --outfile s.exr", "x,y"},
                  {"splitn i0.exr i1.exr --crop 3,4, --outfile s.exr", "x,y"},
                  {"splitn i0.exr i1.exr --crop 0,7 --cropsize 6 --outfile s.exr", "48 x 12"},
                  {"splitn i0.exr i1.exr --crop 2147483640,0 --cropsize 16 --outfile s.exr", "beyond the 48 x 12"},
                  {"splitn i0.exr i1.exr --crop 0,0 --cropsize 13 --outfile s.exr", "beyond the 48 x 12"}});
}

TEST_F(Imgtool, BloomSpreadsBrightPixelsAndKeepsTheirLight) {
    Image image = Constant({41, 41}, 0.5f);
    image.Set({20, 20}, 0, 8);
    image.Set({20, 20}, 1, 4);
    WriteImage(Path("a.exr"), image);
    const Outcome o = Run("bloom a.exr --level 2 --width 7 --iterations 2 --scale 0.4 --outfile b.exr");
    EXPECT_EQ(o.status, 0) << o.err;
    EXPECT_TRUE(Has(o.out, "1 pixel in bloom")) << o.out;
    const Image b = ReadImage(Path("b.exr")).image;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(Sum(b, c) - Sum(image, c), 0.4 * double(image.Get({20, 20}, c)), 1e-3);
    // One and two passes with the weights w[0..3] along both axes, computed by hand.
    double w[4], sum = 0, twice = 0;
    for (int i = 0; i < 4; ++i) sum += (i ? 2 : 1) * (w[i] = std::exp(-i * i / (2 * (7 / 6.) * (7 / 6.))));
    for (int i = 0; i < 4; ++i) twice += (i ? 2 : 1) * (w[i] / sum) * (w[i] / sum);
    EXPECT_NEAR(b.Get({20, 20}, 0), 8 + 0.2 * 8 * (w[0] * w[0] / (sum * sum) + twice * twice), 1e-4);
    EXPECT_NEAR(double(b.Get({20 + 6, 20}, 0)) - 0.5, 0.2 * 8 * std::pow(w[3] / sum, 2) * twice, 1e-6);
    EXPECT_EQ(b.Get({20 + 7, 20}, 0), 0.5f);

    EXPECT_TRUE(Has(Run("bloom a.exr --outfile c.exr").err, "nothing blooms"));
    EXPECT_EQ(Run("diff a.exr --reference c.exr").status, 0);
    Write("grey.exr", 4, 4, {"Y"});
    ExpectErrors(
        {{"bloom a.exr --width 8 --outfile c.exr", "odd"}, {"bloom grey.exr --outfile c.exr", "no channel R"}});
}

TEST_F(Imgtool, WhitebalanceMakesTheLightsColourGrey) {
    auto white = [&](const Spectrum &s, const ColorSpace &space) {
        const Rgb rgb = space.ToRgb(SpectrumToXyz(s));
        ImageMetadata metadata;
        metadata.colorSpace = &space;
        WriteImage(Path("a.exr"), RgbImage({2, 1}, [&](int x, int) { return x ? rgb : Rgb(0); }), metadata);
    };
    auto balanced = [&](const std::string &how) {
        return RgbAt(Written("whitebalance a.exr " + how + " --outfile b.exr").image, {1, 0});
    };
    auto expectGrey = [&](const std::string &how) {
        const Rgb rgb = balanced(how);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(rgb[c], 1, 4e-3f) << how;
    };
    white(*NamedSpectrum("stdillum-A"), *ColorSpace::Find("rec2020"));
    expectGrey("--illuminant stdillum-A");
    expectGrey("--primaries 0.44757,0.40745");
    white(DaylightSpectrum(9000), ColorSpace::SRGB());
    expectGrey("--temperature 9000");
    white(*NamedSpectrum("stdillum-A"), ColorSpace::SRGB());
    expectGrey("--illuminant A");
    const Rgb same = balanced("--primaries 0.3127,0.329"), given = RgbAt(ReadImage(Path("a.exr")).image, {1, 0});
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(same[c], given[c], 1e-3f);
    ExpectErrors({{"whitebalance a.exr --outfile b.exr", "One of"},
                  {"whitebalance a.exr --outfile b.exr --illuminant D66", "stdillum-D65"},
                  {"whitebalance a.exr --outfile b.exr --illuminant A --temperature 5000", "excludes"},
                  {"whitebalance a.exr --outfile b.exr --primaries 0.5,0.5", "below 1"},
                  {"whitebalance a.exr --outfile b.exr --temperature 10", "1000"}});
}

TEST_F(Imgtool, ScalenormalmapScalesSlopes) {
    const Vector3 n = Normalize(Vector3(0.3f, -0.2f, 0.8f));
    const Image image =
        RgbImage({2, 1}, [&](int x, int) { return x ? Rgb(0.5f, 0.5f, 1) : (n + Vector3(1)) / Float(2); });
    WriteImage(Path("a.exr"), image);
    const Image b = Written("scalenormalmap a.exr --scale 3 --outfile b.exr").image;
    const Vector3 steep = Normalize(Vector3(0.9f, -0.6f, 0.8f));
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(2 * b.Get({0, 0}, c) - 1, steep[c], 1e-5f);
        EXPECT_EQ(b.Get({1, 0}, c), image.Get({1, 0}, c));
    }
    EXPECT_NEAR(Written("scalenormalmap b.exr --scale 0.3333333 --outfile c.exr").image.Get({0, 0}, 1),
                image.Get({0, 0}, 1), 1e-5f);
    // Bytes are values times 255, without the sRGB curve.
    RunWell("scalenormalmap a.exr --outfile d.png");
    RunWell("scalenormalmap d.png --outfile e.PNG");
    for (const char *file : {"d.png", "e.PNG"}) {
        const Image png = ReadImage(Path(file), ColorEncoding{ColorEncoding::Kind::Linear}).image;
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(png.Get({0, 0}, c), image.Get({0, 0}, c), 0.6f / 255) << file;
    }
}

TEST_F(Imgtool, MakeequiareaShowsEveryDirectionItsColour) {
    constexpr int kWidth = 256;
    auto color = [](const Vector3 &w, int c) { return 1 + w[c] + 2 * w.x * w.y * w[c]; };
    WriteImage(Path("a.exr"), RgbImage({kWidth, kWidth / 2}, [&](int x, int y) {
                   const Float theta = (Float(y) + 0.5f) / (kWidth / 2) * Pi;
                   const Float phi = (Float(x) + 0.5f) / kWidth * 2 * Pi;
                   const Vector3 w(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
                   return Rgb(color(w, 0), color(w, 1), color(w, 2));
               }));
    EXPECT_EQ(RunWell("makeequiarea a.exr --outfile b.exr"), "");
    RunWell("makeequiarea a.exr --resolution 37 --outfile small.exr");
    for (auto [file, size, tolerance] : {std::tuple("b.exr", kWidth, 0.003f), std::tuple("small.exr", 37, 0.05f)}) {
        const Image b = ReadImage(Path(file)).image;
        ASSERT_EQ(b.Resolution(), Point2i(size));
        ForEachValue(b, [&, side = Float(size), most = tolerance](Point2i p, int c) {
            const Vector3 w = EqualAreaSquareToSphere((Point2(p) + Point2(0.5f)) / side);
            ASSERT_NEAR(b.Get(p, c), color(w, c), most) << p.x << " " << p.y;
        });
    }
    Write("square.exr", 4, 4, kRgb);
    EXPECT_TRUE(Has(Run("makeequiarea square.exr --outfile c.exr").err, "twice as wide"));
}

// A map with one bright pixel: a command that looks up the map only at the centres of its pixels would miss the bright
// one.
TEST_F(Imgtool, MakeequiareaLosesNoLightInSmallMaps) {
    constexpr int kWidth = 128;
    Image map(PixelFormat::Float, {kWidth, kWidth / 2}, kRgb);
    map.Set({101, 21}, 0, 1000);
    WriteImage(Path("a.exr"), map);
    const double light = Sum(Written("makeequiarea a.exr --resolution 8 --outfile b.exr").image, 0);
    const double top = double(Pi) * 21 / (kWidth / 2),
                 solidAngle = 2 * double(Pi) / kWidth * (std::cos(top) - std::cos(top + double(Pi) / (kWidth / 2)));
    EXPECT_NEAR(light * 4 * double(Pi) / 64, 1000 * solidAngle, 0.1 * 1000 * solidAngle);
}

}  // namespace pbrt
