#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "imgtool_program.h"

namespace pbrt {

TEST_F(Imgtool, HelpExplainsTheCommandsAndOptionsOfTheDocument) {
    std::ifstream document(PBRT_SOURCE_DIR "/docs/reference/compatibility.md");
    static const std::regex kRow(R"(\| `(\w+)` \| (.*?) ?\|.*)"), kOption("--[a-z0-9]+");
    auto options = [](const std::string &text) {
        std::set<std::string> found;
        for (std::sregex_iterator i(text.begin(), text.end(), kOption), end; i != end; ++i) found.insert(i->str());
        found.erase("--help");
        return found;
    };
    std::map<std::string, std::set<std::string>> documented;
    bool here = false;
    for (std::string line; std::getline(document, line);) {
        if (line.starts_with("## ")) here = line == "## imgtool";
        std::smatch cells;
        if (here && std::regex_match(line, cells, kRow)) documented[cells[1]] = options(cells[2]);
    }
    EXPECT_EQ(documented.size(), 15u);
    const std::string overview = Run("help").out;
    EXPECT_EQ(Run("--help").out, overview);
    EXPECT_EQ(Run("diff --help").out, Run("help diff").out);
    EXPECT_EQ(Run("diff -h").out, Run("help diff").out);
    for (const auto &[command, known] : documented) {
        const Outcome o = Run("help " + command);
        EXPECT_EQ(o.status, 0) << command;
        EXPECT_EQ(o.err, "");
        EXPECT_TRUE(Has(overview, command)) << command;
        EXPECT_TRUE(Has(o.out, "Usage: imgtool " + command + " ") && Has(o.out, "Example: imgtool ")) << o.out;
        // Options are at the beginnings of lines; the text after them may name other options.
        std::string list;
        static const std::regex kLine("\n  (?:-\\w,)?(--[a-z0-9]+)");
        for (std::sregex_iterator i(o.out.begin(), o.out.end(), kLine), end; i != end; ++i) list += i->str(1) + ' ';
        EXPECT_EQ(known, options(list)) << command;
    }
}

TEST_F(Imgtool, UsageErrorsListTheChoices) {
    ExpectErrors(
        {{"", "Commands: info convert diff error falsecolor average assemble merge splitn bloom whitebalance "},
         {"frobnicate", "frobnicate"},
         {"help frobnicate", "falsecolor"},
         {"convert a.exr --outfile b.exr --sharpen", "unknown flag --sharpen\n"},
         {"convert --exposre 2 --outfile v.png v.exr", "Error: unknown flag --exposre; did you mean --exposure?\n"},
         {"diff a.exr -metrc MSE", "unknown flag -metrc; did you mean --metric?"},
         {"convert a.exr --Despik 9 --outfile b.exr", "unknown flag --Despik"},
         {"convert a.exr --aces-filmic --outfile b.exr", "Error: --aces-filmic: "},
         {"diff a.exr --reference b.exr --crop 1,2 c.exr", "--crop takes 4 numbers, x0,x1,y0,y1: \"c.exr\" is not a"},
         {"--versoin", "unknown flag --versoin; did you mean --version?"},
         {"convert a.exr --outfile b.exr --sharpen", "--tonemap"},
         {"convert a.exr", "--outfile"},
         {"convert a.exr --outfile b.exr --scale x", "scale"},
         {"diff a.exr", "--reference"},
         {"info", "files"},
         {"info missing.exr", "missing.exr: No such"}});
}

TEST_F(Imgtool, NumbersAreFiniteAndInRange) {
    WriteImage(Path("a.exr"), Constant({16, 16}, 1));
    std::vector<std::pair<std::string, std::string>> cases = {
        {"convert a.exr b.exr --scale ''", "--scale: \"\" is not a finite number\n"},
        {"convert a.exr b.exr --scale=", "--scale: the value after = is missing\n"},
        {"convert a.exr b.exr --scale 1e39", "--scale: \"1e39\" is not a finite number\n"},
        {"convert a.exr b.exr --channels ''", "--channels: the value is empty\n"},
        {"convert a.exr ''", "outfile: the value is empty\n"},
        {"convert a.exr b.exr --exposure 101", "--exposure: \"101\" is not a number from -100 to 100\n"},
        {"convert a.exr b.exr --gamma 0", "--gamma: \"0\" is not a finite number above 0\n"},
        {"convert a.exr b.exr --clamp -1", "--clamp: \"-1\" is not a finite number from 0\n"},
        {"convert a.exr b.exr --repeatpix 1e3", "--repeatpix: \"1e3\" is not an integer from 1 to 65536\n"},
        {"convert a.exr b.exr --repeatpix 65536", "an image of 1048576 x 1048576 pixels needs"},
        {"convert a.exr b.exr --crop 0,1,0,0.5", "--crop: \"0.5\" is not an integer from -2147483648 to 2147483647\n"},
        {"convert a.exr b.exr --scale 1 --scale 2", "--scale: is given more than once\n"},
        {"convert a.exr b.exr --outfile c.exr", "outfile: is given more than once\n"}};
    for (const char *flag :
         {"convert a.exr b.exr --exposure", "convert a.exr b.exr --scale", "convert a.exr b.exr --clamp",
          "falsecolor a.exr b.png --maxvalue", "bloom a.exr b.exr --level", "whitebalance a.exr b.exr --temperature",
          "scalenormalmap a.exr b.exr --scale", "makesky --outfile s.exr --elevation",
          "makesky --outfile s.exr --turbidity"})
        for (const std::string value : {"nan", "inf", "1e400", "much"})
            cases.push_back({fmt::format("{} {}", flag, value), fmt::format("\"{}\" is not a ", value)});
    ExpectErrors(cases);
}

TEST_F(Imgtool, AFailureOfStandardOutputIsAnError) {
    WriteImage(Path("a.exr"), Constant({4, 3}, 1));
    launcher_ = R"(sh -c 'exec "$0" "$@" > /dev/full')";
    for (const char *arguments : {"--version", "help diff", "info a.exr", "info --json a.exr"}) {
        const Outcome o = Run(arguments);
        EXPECT_EQ(o.status, 1) << arguments;
        ExpectWords(o.err, {"Error:", "standard output"});
    }
}

TEST_F(Imgtool, InfoShowsWindowsSpaceMetadataAndStatistics) {
    Image image(PixelFormat::Half, {2, 1}, kRgb);
    image.Set({0, 0}, 0, 0.5f);
    image.Set({1, 0}, 0, 1.5f);
    image.Set({0, 0}, 1, NAN);
    image.Set({0, 0}, 2, 8);
    ImageMetadata metadata;
    metadata.pixelBounds = Bounds2i{{3, 4}, {5, 5}};
    metadata.fullResolution = Point2i(10, 20);
    metadata.colorSpace = ColorSpace::Find("rec2020");
    metadata.attributes["samplesPerPixel"] = 64;
    metadata.attributes["commandLine"] = std::string("pbrt x");
    glm::mat4 m(1);
    m[3].x = 42;
    metadata.attributes["worldToCamera"] = m;
    WriteImage(Path("a.exr"), image, metadata);
    const Outcome o = Run("info a.exr");
    EXPECT_EQ(o.status, 0) << o.err;
    ExpectWords(o.out, {"2 x 1", "half", "10 x 20", "x 3 to 5, y 4 to 5", "samplesPerPixel: 64", "\"pbrt x\"",
                        "worldToCamera", metadata.colorSpace->Name()});
    for (const char *row : {"1 +0 +0 +42\n", "R +0\\.5 +1 +1\\.5 +0 +0\n", "G +0 +0 +0 +1 +0\n"})
        EXPECT_TRUE(std::regex_search(o.out, std::regex(row))) << row << o.out;
}

TEST_F(Imgtool, InfoAndDiffSpeakJson) {
    Image image(PixelFormat::Float, {2, 1}, kRgb);
    image.Set({0, 0}, 0, 0.01f);
    image.Set({1, 0}, 0, 0.03f);
    image.Set({0, 0}, 1, NAN);
    ImageMetadata metadata;
    metadata.colorSpace = ColorSpace::Find("rec2020");
    metadata.attributes["samplesPerPixel"] = 64;
    metadata.attributes["seconds"] = 0.1f;
    metadata.attributes["text"] = std::string("a \"b\"");
    WriteImage(Path("a.exr"), image, metadata);
    const Outcome o = Run("info a.exr a.exr --json");
    EXPECT_EQ(o.status, 0) << o.err;
    const auto json = nlohmann::json::parse(o.out);
    ASSERT_EQ(json.size(), 2u);
    EXPECT_EQ(json[0], json[1]);
    EXPECT_EQ(json[0]["width"], 2);
    EXPECT_EQ(json[0]["colorSpace"], "rec2020");
    EXPECT_EQ(json[0]["window"]["x1"], 2);
    EXPECT_EQ(json[0]["attributes"]["samplesPerPixel"], 64);
    EXPECT_EQ(json[0]["attributes"]["text"], "a \"b\"");
    EXPECT_EQ(json[0]["channels"][0]["name"], "R");
    EXPECT_EQ(json[0]["channels"][1]["nan"], 1);
    ExpectWords(o.out, {"\"seconds\": 0.1,", "\"min\": 0.01,"});  // without the digits of doubles

    image.Set({0, 0}, 1, 0);
    WriteImage(Path("a.exr"), image, metadata);
    image.Set({0, 0}, 1, 1);
    WriteImage(Path("b.exr"), image, metadata);
    const Outcome differ = Run("diff a.exr --reference b.exr --metric MAE --json"),
                  equal = Run("diff a.exr --reference a.exr --json");
    EXPECT_EQ(differ.status, 1);
    EXPECT_NEAR(nlohmann::json::parse(differ.out)["error"].get<double>(), 1 / 6., 1e-6);
    EXPECT_EQ(equal.status, 0);
    EXPECT_EQ(nlohmann::json::parse(equal.out)["error"], 0.0);
}

TEST_F(Imgtool, DiffOfEqualImagesIsSilent) {
    Write("a.exr", 4, 3, kRgb);
    Write("b.exr", 4, 3, kRgb);
    for (const char *metric : {"MAE", "MSE", "MRSE", "relL2", "relL2Abs", "SMAPE", "FLIP", "HDR-FLIP"}) {
        const Outcome o = Run(std::string("diff a.exr --reference b.exr --metric ") + metric);
        EXPECT_EQ(o.status, 0);
        EXPECT_EQ(o.out + o.err, "");
    }
}

TEST_F(Imgtool, DiffReportsBothAveragesDeltaAndMetric) {
    WriteImage(Path("a.exr"), Constant({2, 2}, 3));
    WriteImage(Path("b.exr"), Constant({2, 2}, 2));
    const Outcome o = Run("diff a.exr --reference b.exr --outfile e.exr");
    EXPECT_EQ(o.status, 1);
    EXPECT_EQ(o.err, "");
    ExpectWords(o.out, {"averages: 3 and 2 (+50% delta)", "MSE: 1"});
    EXPECT_TRUE(Has(Run("diff a.exr --reference b.exr --metric=relL2").out, "relL2: 0.247525"));
    EXPECT_TRUE(Has(Run("diff a.exr --reference b.exr --metric=relL2Abs").out, "relL2Abs: 0.249377"));
    EXPECT_TRUE(Has(Run("diff a.exr -Reference b.exr --Metric MAE").out, "MAE: 1"));
    const Image errors = ReadImage(Path("e.exr")).image;
    EXPECT_EQ(errors.Resolution(), Point2i(2, 2));
    EXPECT_EQ(errors.Get({1, 1}, 2), 1);
}

// FLIP of black and white is 0.9674 (see flip_test.cpp).
TEST_F(Imgtool, DiffByFlipWritesOneValuePerPixel) {
    for (auto [name, value] : {std::pair("black.exr", 0.f), std::pair("white.exr", 1.f), std::pair("lamp.exr", 8.f)})
        WriteImage(Path(name), Constant({6, 5}, value));
    const Outcome o = Run("diff black.exr --reference white.exr --metric FLIP --outfile e.exr");
    EXPECT_EQ(o.status, 1);
    EXPECT_TRUE(Has(o.out, "FLIP: 0.967")) << o.out;
    const Image errors = ReadImage(Path("e.exr")).image;
    EXPECT_EQ(errors.Resolution(), Point2i(6, 5));
    EXPECT_EQ(errors.ChannelCount(), 1);
    EXPECT_NEAR(errors.Get({3, 2}, 0), 0.9674f, 1e-3f);
    // Both pictures are white on a screen; at other exposures they differ.
    EXPECT_EQ(Run("diff lamp.exr --reference white.exr --metric FLIP").status, 0);
    EXPECT_EQ(Run("diff lamp.exr --reference white.exr --metric HDR-FLIP").status, 1);
}

TEST_F(Imgtool, DiffComparesOnlyTheChosenPart) {
    Image image = Write("a.exr", 4, 3, kRgb);
    image.Set({3, 2}, 2, 9);
    WriteImage(Path("b.exr"), image);
    EXPECT_EQ(Run("diff a.exr --reference b.exr").status, 1);
    EXPECT_EQ(Run("diff a.exr --reference b.exr --channels R,G").status, 0);
    EXPECT_EQ(Run("diff a.exr --reference b.exr --crop 0,3,0,3").status, 0);
    EXPECT_EQ(Run("diff a.exr --reference b.exr --crop 3,4,2,3").status, 1);
}

TEST_F(Imgtool, DiffNeverCallsInvalidPixelsEqual) {
    WriteRow("nan.exr", {NAN});
    EXPECT_EQ(Run("diff nan.exr --reference nan.exr").status, 1);
}

TEST_F(Imgtool, DiffOfImagesThatDoNotMatchIsAnError) {
    Write("a.exr", 4, 3, kRgb);
    Write("small.exr", 3, 3, kRgb);
    Write("grey.exr", 4, 3, {"Y"});
    ImageMetadata metadata;
    metadata.colorSpace = ColorSpace::Find("aces2065-1");
    WriteImage(Path("aces.exr"), ReadImage(Path("a.exr")).image, metadata);
    ExpectErrors({{"diff a.exr --reference small.exr", "resolution"},
                  {"diff a.exr --reference grey.exr", "channels"},
                  {"diff a.exr --reference aces.exr", "colour space"},
                  {"diff grey.exr --reference grey.exr --metric FLIP", "R, G and B"},
                  {"diff a.exr --reference a.exr --metric PSNR", "relL2"},
                  {"diff a.exr --reference a.exr --channels R,Q", "\"Q\""},
                  {"diff a.exr --reference a.exr --crop 0,5,0,3", "4 x 3"},
                  {"diff a.exr --reference a.exr --crop 2,2,0,3", "x0,x1,y0,y1"}});
}

/// Pixels x 8 to 16, y 1 to 6 of a picture of 16 x 12; the red of a pixel is x + 100 y of the whole picture.
ImageFile CropRender() {
    ImageFile file{RgbImage({8, 5}, [](int x, int y) { return Rgb(x + 8 + 100 * (y + 1), 0, 0); }), {}};
    file.metadata.pixelBounds = Bounds2i{{8, 1}, {16, 6}};
    file.metadata.fullResolution = Point2i(16, 12);
    return file;
}

TEST_F(Imgtool, CropsCountInPixelsOfTheWholePicture) {
    const ImageFile part = CropRender();
    WriteImage(Path("tr.exr"), part.image, part.metadata);
    const ImageFile crop = Written("convert tr.exr --crop 9,12,2,4 --outfile c.exr");
    EXPECT_EQ(crop.image.Resolution(), Point2i(3, 2));
    EXPECT_EQ(crop.metadata.pixelBounds->low, Point2i(9, 2));
    EXPECT_EQ(crop.metadata.fullResolution, Point2i(16, 12));
    EXPECT_EQ(crop.image.Get({0, 0}, 0), 209);
    Image other = part.image;
    other.Set({1, 1}, 0, 0);  // x 9, y 2 of the picture
    WriteImage(Path("other.exr"), other, part.metadata);
    EXPECT_EQ(Run("diff tr.exr --reference other.exr --crop 10,16,1,6").status, 0);
    EXPECT_EQ(Run("diff tr.exr --reference other.exr --crop 9,10,2,3").status, 1);
    EXPECT_TRUE(Has(Run("error other.exr --reference tr.exr --metric MAE --crop 9,10,2,3").out, "MAE: mean 69.6667"));
    EXPECT_EQ(Written("splitn tr.exr other.exr --crop 9,2 --cropsize 1 --outfile s.exr").image.Get({0, 9}, 0), 209);
    // A part is compared with the whole, if the file says where it lies.
    const Image whole = RgbImage({16, 12}, [](int x, int y) { return Rgb(x + 100 * y, 0, 0); });
    for (const char *name : {"whole.exr", "whole.pfm"}) WriteImage(Path(name), whole);
    EXPECT_EQ(Run("diff tr.exr --reference whole.exr --crop 9,12,1,4").status, 0);
    EXPECT_EQ(Run("diff other.exr --reference whole.exr --crop 9,12,1,4").status, 1);
    EXPECT_TRUE(Has(Run("error other.exr --reference whole.exr --metric MAE --crop 9,10,2,3").out, "mean 69.6667"));
    ExpectErrors({{"diff tr.exr --reference whole.exr", "Different resolutions"},
                  {"diff tr.exr --reference whole.pfm --crop 0,4,0,3", "Different resolutions"},
                  {"diff tr.exr --reference whole.exr --crop 0,4,0,3", "x 8 to 16"}});
    ImageMetadata elsewhere = part.metadata;
    elsewhere.pixelBounds = Bounds2i{{0, 1}, {8, 6}};
    WriteImage(Path("left.exr"), part.image, elsewhere);
    ExpectErrors({{"convert tr.exr --crop 1,4,1,4 --outfile c.exr", "8 x 5 pixels: x 8 to 16, y 1 to 6"},
                  {"diff tr.exr --reference tr.exr --crop 8,17,1,6", "x 8 to 16"},
                  {"diff tr.exr --reference left.exr", "Different parts of an image"},
                  {"error tr.exr --reference left.exr", "Different parts of an image"},
                  {"average tr.exr left.exr --outfile m.exr", "Different parts of an image"},
                  {"splitn tr.exr left.exr --outfile s.exr", "Different parts of an image"},
                  {"makeequiarea tr.exr --outfile m.exr", "part of an image of 16 x 12"}});
}

TEST_F(Imgtool, DataWindowsMoveWithThePixels) {
    const ImageFile part = CropRender();
    WriteImage(Path("tr.exr"), part.image, part.metadata);
    const ImageFile flipped = Written("convert tr.exr --flipy --outfile f.exr");
    EXPECT_EQ(flipped.metadata.pixelBounds, (Bounds2i{{8, 6}, {16, 11}}));  // rows 1 to 6 of 12 become 6 to 11
    EXPECT_EQ(flipped.image.Get({0, 4}, 0), 108);
    const ImageFile repeated = Written("convert tr.exr --repeatpix 3 --outfile r.exr");
    EXPECT_EQ(repeated.metadata.pixelBounds, (Bounds2i{{24, 3}, {48, 18}}));
    EXPECT_EQ(repeated.metadata.fullResolution, Point2i(48, 36));
    ImageMetadata farOff = part.metadata;
    farOff.pixelBounds = Bounds2i{{400000, 1}, {400008, 6}};
    farOff.fullResolution = Point2i(500000, 12);
    WriteImage(Path("far.exr"), part.image, farOff);
    ExpectErrors({{"convert far.exr --repeatpix 6000 --outfile r.exr", "too large"}});
    EXPECT_EQ(Written("falsecolor tr.exr --outfile v.exr").metadata.pixelBounds->low, Point2i(8, 1));
    RunWell("falsecolor tr.exr --ramp --outfile v.exr");
    // A crop of a format without windows keeps its place and the size of the whole.
    WriteImage(Path("p.pfm"), part.image);
    const ImageMetadata cropped = Written("convert p.pfm --crop 1,7,0,2 --flipy --outfile c.exr").metadata;
    EXPECT_EQ(cropped.pixelBounds, (Bounds2i{{1, 3}, {7, 5}}));
    EXPECT_EQ(cropped.fullResolution, Point2i(8, 5));
}

TEST_F(Imgtool, ClampKeepsTheHue) {
    Image image(PixelFormat::Float, {3, 1}, {"R", "G", "B", "A", "Depth"});
    const Float values[3][5] = {{2, 1, 0.5f, 1, 9}, {0.25f, 0.5f, 0, 1, 0.1f}, {INFINITY, 1, 0.25f, 1, 0}};
    ForEachValue(image, [&](Point2i p, int c) { image.Set(p, c, values[p.x][c]); });
    WriteImage(Path("a.exr"), image);
    const Image clamped = Written("convert a.exr --clamp 0.5 --outfile c.exr").image.Select(image.Channels());
    const Float expected[3][5] = {{0.5f, 0.25f, 0.125f, 1, 0.5f}, {0.25f, 0.5f, 0, 1, 0.1f}, {0.5f, 0.5f, 0.25f, 1, 0}};
    ForEachValue(clamped,
                 [&](Point2i p, int c) { EXPECT_FLOAT_EQ(clamped.Get(p, c), expected[p.x][c]) << p.x << " " << c; });
}

TEST_F(Imgtool, ConvertChangesColours) {
    const Image image = Write("a.exr", 2, 2, {"R", "G", "B", "A"});
    auto converted = [&](const std::string &flags) {
        return Written("convert a.exr " + flags + " --outfile c.exr").image;
    };
    const Point2i p(1, 1);
    const Image scaled = converted("--scale 2");
    EXPECT_EQ(scaled.Format(), PixelFormat::Float);
    EXPECT_FLOAT_EQ(scaled.Get(p, 0), 2 * image.Get(p, 0));
    EXPECT_FLOAT_EQ(scaled.Get(p, 3), image.Get(p, 3));
    EXPECT_FLOAT_EQ(converted("--scale=-2 --clamp 0.5").Get(p, 2), -0.5f);
    EXPECT_FLOAT_EQ(converted("--exposure 1.5").Get(p, 1), std::exp2(1.5f) * image.Get(p, 1));
    EXPECT_FLOAT_EQ(converted("--exposure -2 --scale 8").Get(p, 1), 2 * image.Get(p, 1));
    EXPECT_FLOAT_EQ(converted("--gamma 2").Get(p, 1), Sqr(image.Get(p, 1)));
    EXPECT_FLOAT_EQ(converted("--flipy").Get({1, 0}, 2), image.Get({1, 1}, 2));
    EXPECT_EQ(converted("--fp16").Format(), PixelFormat::Half);
    const Image blueRed = converted("--channels B,R");
    EXPECT_EQ(blueRed.ChannelCount(), 2);
    EXPECT_EQ(blueRed.Get(p, blueRed.FindChannel("B")), image.Get(p, 2));
    Write("spectral.exr", 2, 2, {"S0.450,000nm", "S0.550,000nm", "S0.650,000nm"});
    EXPECT_EQ(Written("convert spectral.exr --channels S0.650,000nm,S0.450,000nm --outfile s.exr").image.ChannelCount(),
              2);
    const Image grey = converted("--bw");
    EXPECT_EQ(grey.ChannelCount(), 1);
    EXPECT_FLOAT_EQ(grey.Get(p, 0), (image.Get(p, 0) + image.Get(p, 1) + image.Get(p, 2)) / 3);
    const Image repeated = converted("--repeatpix 3");
    EXPECT_EQ(repeated.Resolution(), Point2i(6, 6));
    for (int i = 3; i < 6; ++i) EXPECT_EQ(repeated.Get({i, 2}, 0), image.Get({1, 0}, 0));
}

TEST_F(Imgtool, TonemapMapsTheMaximumLuminanceToOneAndKeepsHue) {
    WriteImage(Path("a.exr"), RgbImage({2, 1}, [](int x, int) { return x ? Rgb(2, 1, 0) : Rgb(4); }));
    const Image mapped = Written("convert a.exr --tonemap --maxluminance 4 --outfile t.exr").image;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(mapped.Get({0, 0}, c), 1, 1e-4f);
    EXPECT_NEAR(mapped.Get({1, 0}, 0) / mapped.Get({1, 0}, 1), 2, 1e-5f);
    // The sRGB luminance is 0.2126 * 2 + 0.7152.
    const Float luminance = 1.1404f;
    EXPECT_NEAR(mapped.Get({1, 0}, 1), (1 + luminance / 16) / (1 + luminance), 1e-3f);
    // By default that of the brightest pixel.
    WriteImage(Path("b.exr"), RgbImage({2, 1}, [](int x, int) { return Rgb(x ? 1.f : 8.f); }));
    const Image byDefault = Written("convert b.exr --exposure 1 --tonemap --outfile t.exr").image;
    EXPECT_NEAR(byDefault.Get({0, 0}, 1), 1, 1e-4f);
    EXPECT_NEAR(byDefault.Get({1, 0}, 1), 2 * (1 + 2 / 256.f) / 3, 1e-4f);
    WriteImage(Path("i.exr"), RgbImage({2, 1}, [](int x, int) { return Rgb(x ? 1.f : INFINITY); }));
    const Image infinite = Written("convert i.exr --tonemap --outfile t.exr").image;
    EXPECT_EQ(RgbAt(infinite, {0, 0}), Rgb(INFINITY)) << "white in files of bytes";
    EXPECT_NEAR(infinite.Get({1, 0}, 1), 1, 1e-4f);
    ExpectErrors({{"convert b.exr --maxluminance 4 --outfile t.exr", "--tonemap"}});
}

TEST_F(Imgtool, ConvertWritesEveryFormatAndNoOther) {
    const Image image = Write("a.exr", 3, 1, kRgb);
    for (auto [name, tolerance] :
         {std::pair("a.pfm", 0.f), std::pair("a.png", 0.005f), std::pair("a.jpg", 0.03f), std::pair("B.EXR", 0.f)})
        EXPECT_NEAR(Written(std::string("convert a.exr ") + name).image.Get({2, 0}, 1), image.Get({2, 0}, 1),
                    tolerance);
    EXPECT_EQ(Written("convert a.png --outfile b.exr").image.Format(), PixelFormat::Half);
    ExpectErrors({{"convert a.exr --outfile a.tiff", ".png"}, {"convert a.exr b.exr c.exr", "c.exr"}});
}

TEST_F(Imgtool, FalsecolorOrdersValuesAndMarksInvalidOnes) {
    WriteRow("a.exr", {0, 1, 2, NAN});
    const Outcome o = Run("falsecolor a.exr --ramp --outfile f.png");
    EXPECT_EQ(o.status, 0) << o.err;
    ExpectWords(o.out, {"0 to 2"});
    EXPECT_EQ(o.err, "");
    const Image shown = ReadImage(Path("f.png")).image;
    EXPECT_GT(shown.Resolution().y, 1);
    auto luminance = [&](int x, int y) {
        return 0.2f * shown.Get({x, y}, 0) + 0.7f * shown.Get({x, y}, 1) + 0.1f * shown.Get({x, y}, 2);
    };
    EXPECT_LT(luminance(0, 0), luminance(1, 0));
    EXPECT_LT(luminance(1, 0), luminance(2, 0));
    EXPECT_EQ(shown.Get({3, 0}, 1), 0);
    for (int x = 0; x < 3; ++x) EXPECT_LT(luminance(x, 5), luminance(x + 1, 5));
    EXPECT_EQ(Written("falsecolor a.exr --outfile g.png").image.Resolution(), Point2i(4, 1));
    EXPECT_TRUE(Has(Run("falsecolor a.exr --maxvalue 8 --outfile h.png").out, "0 to 8"));
}

// One bright lamp must not make the rest of the room black.
TEST_F(Imgtool, FalsecolorShowsTheImageAndNotItsBrightestPixels) {
    Image image(PixelFormat::Float, {50, 40}, {"Y"});
    ForEachPixel(image, [&](Point2i p) { image.Set(p, 0, p.y == 0 && p.x < 15 ? 1000 : Float(p.x + 1) / 50); });
    WriteImage(Path("a.exr"), image);
    ExpectWords(Run("falsecolor a.exr f.png").out, {"f.png: 0 to 1", "99 %", "1000"});
    const Image shown = ReadImage(Path("f.png")).image;
    EXPECT_GT(shown.Get({40, 20}, 0), shown.Get({5, 20}, 0) + 0.2f);
    // If most pixels are 0, the others must stay visible.
    ForEachPixel(image, [&](Point2i p) { image.Set(p, 0, p.y == 0 && p.x < 3 ? 5 : 0); });
    WriteImage(Path("b.exr"), image);
    EXPECT_TRUE(Has(Run("falsecolor b.exr f.png").out, "0 to 5\n"));
}

TEST_F(Imgtool, FalsecolorPlusMinusIsBlueBelowAndRedAboveZero) {
    WriteRow("a.exr", {-2, 0, 1});
    ExpectWords(Run("falsecolor a.exr --plusminus --outfile f.exr").out, {"-2 to 2"});
    const Image shown = ReadImage(Path("f.exr")).image;
    EXPECT_GT(shown.Get({0, 0}, 2), shown.Get({0, 0}, 0));
    EXPECT_EQ(shown.Get({1, 0}, 0) + shown.Get({1, 0}, 2), 0);
    EXPECT_GT(shown.Get({2, 0}, 0), shown.Get({2, 0}, 2));
}

TEST_F(Imgtool, AverageIsTheMeanOfAllFilesWithThePrefix) {
    std::filesystem::create_directory(Path("runs"));
    const Image a = Write("runs/seed0.exr", 3, 2, kRgb, 0);
    Write("runs/seed1.exr", 3, 2, kRgb, 1);
    Write("runs/seed2.exr", 3, 2, kRgb, 5);
    Write("runs/other.exr", 3, 2, kRgb, 100);
    const Image mean = Written("average runs/seed --outfile runs/seedmean.exr").image;
    EXPECT_NEAR(mean.Get({2, 1}, 2), a.Get({2, 1}, 2) + 2, 1e-5f);
    // The result of the first run, whose name has the prefix, is not averaged again.
    EXPECT_EQ(Written("average runs/seed --outfile runs/seedmean.exr").image.Get({2, 1}, 2), mean.Get({2, 1}, 2));
    Write("runs/seed3.exr", 2, 2, kRgb);
    ExpectErrors({{"average runs/seed --outfile runs/mean.exr", "seed3.exr"}});
}

}  // namespace pbrt
