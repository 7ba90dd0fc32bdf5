#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "image_fixtures.h"

namespace pbrt::test {

class ReadImageFile : public FolderTest {
  protected:
    using FolderTest::Write;
    // Writes raw values through OpenImageIO, which does no conversion here.
    template <class T>
    std::string Write(const std::string &name, int width, int height, int channels, OIIO::TypeDesc type,
                      const std::vector<T> &values, std::vector<std::string> names = {}) {
        OIIO::ImageSpec spec(width, height, channels, type);
        spec["oiio:UnassociatedAlpha"] = 1;
        spec["jpeg:subsampling"] = "4:4:4";
        spec["compression"] = name.ends_with(".jpg") ? "jpeg:100" : "";
        if (!names.empty()) spec.channelnames = names;
        if (channels == 2) spec.alpha_channel = 1;
        auto out = OIIO::ImageOutput::create(Path(name));
        EXPECT_TRUE(out && out->open(Path(name), spec) && out->write_image(type, values.data()) && out->close())
            << name;
        return Path(name);
    }
};

namespace {
const ColorEncoding kSrgb{};
Float Decoded(int byte) { return kSrgb.ToLinear(Float(byte) / 255); }
}  // namespace

TEST_F(ReadImageFile, PngIsSrgbUnlessTheCallerNamesAnEncoding) {
    const std::string path = Write<uint8_t>("a.png", 2, 1, 3, OIIO::TypeDesc::UINT8, {0, 100, 255, 10, 20, 30});
    const Image image = ReadImage(path).image;
    EXPECT_EQ(image.Format(), PixelFormat::U8);
    EXPECT_EQ(image.Channels(), kRgb);
    EXPECT_FLOAT_EQ(image.Get({0, 0}, 1), Decoded(100));
    EXPECT_FLOAT_EQ(ReadImage(path, ColorEncoding::Parse("linear")).image.Get({0, 0}, 1), 100 / 255.f);
    EXPECT_FLOAT_EQ(ReadImage(path, ColorEncoding::Parse("gamma 2")).image.Get({1, 0}, 2), Sqr(30 / 255.f));
}

TEST_F(ReadImageFile, PngGreyIsOneChannelAndLosesAlpha) {
    const Image grey = ReadImage(Write<uint8_t>("a.png", 2, 1, 1, OIIO::TypeDesc::UINT8, {50, 60})).image;
    EXPECT_EQ(grey.Channels(), kGrey);
    EXPECT_FLOAT_EQ(grey.Get({1, 0}, 0), Decoded(60));
    const Image alpha =
        ReadImage(Write<uint8_t>("b.png", 2, 1, 2, OIIO::TypeDesc::UINT8, {50, 0, 60, 128}, {"Y", "A"})).image;
    EXPECT_EQ(alpha.Channels(), kGrey);
    // The colour is not multiplied by alpha.
    EXPECT_FLOAT_EQ(alpha.Get({0, 0}, 0), Decoded(50));
    EXPECT_FLOAT_EQ(alpha.Get({1, 0}, 0), Decoded(60));
}

TEST_F(ReadImageFile, PngAlphaStaysUnassociated) {
    const Image image =
        ReadImage(Write<uint8_t>("a.png", 2, 1, 4, OIIO::TypeDesc::UINT8, {200, 100, 50, 0, 10, 20, 30, 128})).image;
    EXPECT_EQ(image.Channels(), kRgba);
    EXPECT_FLOAT_EQ(image.Get({0, 0}, 0), Decoded(200));
    EXPECT_FLOAT_EQ(image.Get({1, 0}, 2), Decoded(30));
    // As in stock pbrt-v4, alpha is decoded like a colour.
    EXPECT_FLOAT_EQ(image.Get({1, 0}, 3), Decoded(128));
}

TEST_F(ReadImageFile, SixteenBitPngBecomesLinearHalf) {
    const std::string path =
        Write<uint16_t>("a.png", 2, 1, 3, OIIO::TypeDesc::UINT16, {0, 32768, 65535, 1000, 20000, 40000});
    const Image image = ReadImage(path).image;
    EXPECT_EQ(image.Format(), PixelFormat::Half);
    EXPECT_NEAR(image.Get({0, 0}, 1), kSrgb.ToLinear(32768 / 65535.f), 2e-4f);
    EXPECT_NEAR(ReadImage(path, ColorEncoding::Parse("linear")).image.Get({1, 0}, 1), 20000 / 65535.f, 2e-4f);
    const Image grey = ReadImage(Write<uint16_t>("g.png", 1, 2, 1, OIIO::TypeDesc::UINT16, {65535, 30000})).image;
    EXPECT_EQ(grey.ChannelCount(), 1);
    EXPECT_NEAR(grey.Get({0, 1}, 0), kSrgb.ToLinear(30000 / 65535.f), 2e-4f);
}

TEST_F(ReadImageFile, PalettePngExpandsToRgb) {
    // A palette PNG of 2 x 1 pixels with the entries (255,0,0) and (0,128,255), the second one transparent; written by
    // hand with Python's zlib.
    const std::string path = Write(
        "p.png",
        Bytes({0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52, 0x00,
               0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x01, 0x08, 0x03, 0x00, 0x00, 0x00, 0xc3, 0xfc, 0x8f, 0xb8, 0x00,
               0x00, 0x00, 0x06, 0x50, 0x4c, 0x54, 0x45, 0xff, 0x00, 0x00, 0x00, 0x80, 0xff, 0x57, 0x22, 0x65, 0xc5,
               0x00, 0x00, 0x00, 0x02, 0x74, 0x52, 0x4e, 0x53, 0xff, 0x00, 0xe5, 0xb7, 0x30, 0x4a, 0x00, 0x00, 0x00,
               0x0b, 0x49, 0x44, 0x41, 0x54, 0x78, 0x9c, 0x63, 0x60, 0x60, 0x04, 0x00, 0x00, 0x04, 0x00, 0x02, 0xbf,
               0x7a, 0x3f, 0x4a, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82}));
    const Image image = ReadImage(path).image;
    EXPECT_EQ(image.Channels(), kRgb);
    EXPECT_EQ(image.Get({0, 0}, 0), 1);
    EXPECT_EQ(image.Get({0, 0}, 2), 0);
    EXPECT_FLOAT_EQ(image.Get({1, 0}, 1), Decoded(128));
    EXPECT_EQ(image.Get({1, 0}, 2), 1);
}

TEST_F(ReadImageFile, TgaRowsAndAlphaComeOutAsStored) {
    // An uncompressed Targa file of 2 x 2 pixels, 24-bit BGR. Bit 5 of the descriptor is set: the first row is the
    // top one.
    const std::string header = Bytes({0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 2, 0, 24});
    const std::string pixels = Bytes({1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12});
    const Image bottomUp = ReadImage(Write("up.tga", header + Bytes({0}) + pixels)).image;
    const Image topDown = ReadImage(Write("down.tga", header + Bytes({0x20}) + pixels)).image;
    EXPECT_EQ(topDown.Channels(), kRgb);
    EXPECT_FLOAT_EQ(topDown.Get({0, 0}, 0), Decoded(3));
    EXPECT_FLOAT_EQ(topDown.Get({1, 1}, 2), Decoded(10));
    EXPECT_FLOAT_EQ(bottomUp.Get({0, 1}, 0), Decoded(3));
    EXPECT_FLOAT_EQ(bottomUp.Get({1, 0}, 2), Decoded(10));
    // 32 bits per pixel, 8 of them alpha: alpha is dropped, and colours are not multiplied by it.
    const std::string alphaHeader = Bytes({0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 32, 0x28});
    const Image alpha = ReadImage(Write("alpha.tga", alphaHeader + Bytes({30, 60, 90, 128}))).image;
    EXPECT_EQ(alpha.Channels(), kRgb);
    EXPECT_FLOAT_EQ(alpha.Get({0, 0}, 0), Decoded(90));
    EXPECT_FLOAT_EQ(alpha.Get({0, 0}, 2), Decoded(30));
}

TEST_F(ReadImageFile, OtherByteFormatsAreSrgbForAnyEncodingOfTheCaller) {
    const std::vector<uint8_t> grey(16 * 16 * 3, 100);
    for (const char *name : {"a.bmp", "a.jpg", "a.ppm"}) {
        const std::string path = Write<uint8_t>(name, 16, 16, 3, OIIO::TypeDesc::UINT8, grey);
        const Image image = ReadImage(path, ColorEncoding::Parse("linear")).image;
        EXPECT_EQ(image.Channels(), kRgb) << name;
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(image.Get({7, 7}, c), Decoded(100), 0.004f) << name;
    }
}

TEST_F(ReadImageFile, RadianceIsLinearFloatTopRowFirst) {
    const std::vector<float> values = {1, 2, 4, 8, 16, 32, 0.5f, 0.25f, 0.125f, 3, 3, 3};
    const Image image = ReadImage(Write<float>("a.hdr", 2, 2, 3, OIIO::TypeDesc::FLOAT, values)).image;
    EXPECT_EQ(image.Format(), PixelFormat::Float);
    for (int i = 0; i < 12; ++i) EXPECT_NEAR(image.Get({i / 3 % 2, i / 6}, i % 3), values[i], 0.05f * values[i]) << i;
}

TEST_F(ReadImageFile, RadianceRowsAreUprightAndColumnsAreErrors) {
    // 3 x 2 pixels, not run-length coded; pixel i has the mantissa 16 (i + 1) in red.
    std::string pixels;
    for (int i = 0; i < 6; ++i) pixels += Bytes({16 * (i + 1), 0, 0, 128});
    auto write = [&](const std::string &lines) {
        return Write("o.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n" + lines + "\n" + pixels);
    };
    const std::map<std::string, std::array<int, 6>> rows = {{"-Y 2 +X 3", {0, 1, 2, 3, 4, 5}},
                                                            {"-Y 2 -X 3", {2, 1, 0, 5, 4, 3}},
                                                            {"+Y 2 -X 3", {5, 4, 3, 2, 1, 0}},
                                                            {"+Y 2 +X 3", {3, 4, 5, 0, 1, 2}}};
    for (const auto &[lines, order] : rows) {
        const Image image = ReadImage(write(lines)).image;
        ASSERT_EQ(image.Resolution(), Point2i(3, 2)) << lines;
        for (int i = 0; i < 6; ++i)
            EXPECT_NEAR(image.Get({i % 3, i / 3}, 0), 0.0625 * (order[i] + 1), 0.01) << lines << " " << i;
    }
    for (const char *lines : {"+X 3 -Y 2", "+X 3 +Y 2", "-X 3 -Y 2", "-X 3 +Y 2"})
        ExpectWords(ReadError(write(lines)), {"o.hdr", "column by column"});
}

TEST_F(ReadImageFile, UncompressedTiffOfEveryDepthAndPalette) {
    // 256 x 64 pixels of `bits` bits; 1: grey, 3: palette. The palette's entry i is (255 i / last, 0, 255) of 8 bits.
    auto tiff = [&](uint32_t bits, uint32_t kind, uint32_t rowsLeft) {
        const uint32_t colors = 1 << bits, rowBytes = 32 * bits;
        std::string out = Bytes({'I', 'I', 42, 0, 8, 0, 0, 0});
        auto put = [&](uint32_t v, int bytes) {
            for (int i = 0; i < bytes; ++i) out += char(v >> (8 * i));
        };
        const uint32_t entries = kind == 3 ? 10 : 9, after = 8 + 2 + 12 * entries + 4;
        auto entry = [&](uint32_t tag, uint32_t type, uint32_t count, uint32_t value) {
            put(tag, 2);
            put(type, 2);
            put(count, 4);
            put(value, 4);
        };
        put(entries, 2);
        const std::array<uint32_t, 3> values[] = {
            {256, 3, 256}, {257, 3, 64},   {258, 3, bits},
            {259, 3, 1},   {262, 3, kind}, {273, 4, after + (kind == 3 ? 6 * colors : 0)},
            {277, 3, 1},   {278, 3, 64},   {279, 4, 64 * rowBytes}};
        for (const auto &[tag, type, value] : values) entry(tag, type, 1, value);
        if (kind == 3) entry(320, 3, 3 * colors, after);
        put(0, 4);
        for (uint32_t c = 0; kind == 3 && c < 3; ++c)
            for (uint32_t i = 0; i < colors; ++i) put(c == 0 ? 257 * (255 * i / (colors - 1)) : c == 1 ? 0 : 65535, 2);
        out += std::string(rowsLeft * rowBytes, '\xff');  // the last entry, or white
        return Write("t.tif", out);
    };
    for (const uint32_t kind : {1, 3})
        for (const uint32_t bits : {1, 2, 4, 8}) {
            const Image image = ReadImage(tiff(bits, kind, 64)).image;
            ASSERT_EQ(image.Resolution(), Point2i(256, 64));
            EXPECT_FLOAT_EQ(image.Get({200, 60}, 0), 1) << kind << " " << bits;
            EXPECT_EQ(image.Get({200, 60}, image.ChannelCount() == 3 ? 1 : 0), kind == 3 ? 0 : 1) << bits;
            for (uint32_t rowsLeft : {30, 63}) ExpectWords(ReadError(tiff(bits, kind, rowsLeft)), {"too early"});
        }
}

TEST_F(ReadImageFile, TiffIsUprightOrAnErrorAndStatesItsDepth) {
    // 2 x 2 grey pixels: 0, 85, 170, 255.
    auto tiff = [&](int orientation, bool hasBits = true) {
        std::string out = Bytes({'I', 'I', 42, 0, 8, 0, 0, 0, hasBits ? 9 : 8, 0});
        const int after = hasBits ? 122 : 110;
        for (const auto &[tag, value] : std::initializer_list<std::pair<int, int>>{{256, 2},
                                                                                   {257, 2},
                                                                                   {258, 8},
                                                                                   {259, 1},
                                                                                   {262, 1},
                                                                                   {273, after},
                                                                                   {274, orientation},
                                                                                   {278, 2},
                                                                                   {279, 4}})
            if (tag != 258 || hasBits) out += Bytes({tag & 255, tag >> 8, 3, 0, 1, 0, 0, 0, value, 0, 0, 0});
        return Write("t.tif", out + Bytes({0, 0, 0, 0, 0, 85, 170, 255}));
    };
    const std::array<std::array<int, 4>, 4> orders = {{{0, 1, 2, 3}, {1, 0, 3, 2}, {3, 2, 1, 0}, {2, 3, 0, 1}}};
    for (int orientation = 1; orientation <= 4; ++orientation) {
        const Image image = ReadImage(tiff(orientation)).image;
        for (int i = 0; i < 4; ++i)
            EXPECT_FLOAT_EQ(image.Get({i % 2, i / 2}, 0), Decoded(uint8_t(85 * orders[orientation - 1][i])))
                << orientation << " " << i;
    }
    for (int orientation = 5; orientation <= 8; ++orientation)
        ExpectWords(ReadError(tiff(orientation)), {"t.tif", "column by column"});
    ExpectWords(ReadError(tiff(1, false)), {"t.tif", "BitsPerSample"});
}

TEST_F(ReadImageFile, FormatsThatAreNotListedAreErrors) {
    const std::vector<uint8_t> grey(16 * 16 * 3, 100);
    const std::string path = Write<uint8_t>("a.ico", 16, 16, 3, OIIO::TypeDesc::UINT8, grey);
    ExpectWords(ReadError(path), {"a.ico", "PSD and TIFF"});
}

TEST_F(ReadImageFile, PfmHasItsBottomRowFirstInEitherByteOrder) {
    auto word = [](float v, bool big) {
        uint32_t bits = std::bit_cast<uint32_t>(v);
        std::string s;
        for (int i = 0; i < 4; ++i) s += char(bits >> (big ? 24 - 8 * i : 8 * i));
        return s;
    };
    for (bool big : {false, true}) {
        std::string bytes = big ? "PF\n1 2\n1.0\n" : "PF\n1 2\n-1.0\n";
        for (float v : {1.f, 2.f, 3.f, 4.f, 5.f, 6.5f}) bytes += word(v, big);
        const Image image = ReadImage(Write("a.pfm", bytes)).image;
        EXPECT_EQ(image.Get({0, 1}, 0), 1);
        EXPECT_EQ(image.Get({0, 1}, 2), 3);
        EXPECT_EQ(image.Get({0, 0}, 2), 6.5f);
    }
    const Image grey = ReadImage(Write("g.pfm", "Pf 2 1 -1\n" + word(0.5f, false) + word(7, false))).image;
    EXPECT_EQ(grey.Channels(), kGrey);
    EXPECT_EQ(grey.Get({1, 0}, 0), 7);
}

TEST_F(ReadImageFile, ExrOfMixedTypesKeepsBothExactly) {
    Imf::Header header(2, 1);
    header.channels().insert("R", Imf::Channel(Imf::HALF));
    header.channels().insert("depth", Imf::Channel(Imf::FLOAT));
    half r[2] = {half(0.5f), half(3.f)};
    float depth[2] = {1.2345678f, 1e20f};
    WriteExr(Path("m.exr"), header,
             {{"R", Imf::Slice(Imf::HALF, reinterpret_cast<char *>(r), sizeof(half), 0)},
              {"depth", Imf::Slice(Imf::FLOAT, reinterpret_cast<char *>(depth), sizeof(float), 0)}});
    const Image image = ReadImage(Path("m.exr")).image;
    EXPECT_EQ(image.Get({1, 0}, image.FindChannel("R")), 3);
    EXPECT_EQ(image.Get({0, 0}, image.FindChannel("depth")), depth[0]);
    EXPECT_EQ(image.Get({1, 0}, image.FindChannel("depth")), depth[1]);
}

TEST_F(ReadImageFile, UnknownChromaticitiesWarnAndCountAsSrgb) {
    Imf::Header header(1, 1);
    Imf::addChromaticities(header, {{0.5f, 0.3f}, {0.3f, 0.5f}, {0.2f, 0.1f}, {0.3f, 0.3f}});
    header.channels().insert("Y", Imf::Channel(Imf::HALF));
    half y(1.f);
    WriteExr(Path("odd.exr"), header, {{"Y", Imf::Slice(Imf::HALF, reinterpret_cast<char *>(&y), sizeof(half), 0)}});
    ImageFile file;
    ExpectWords(StderrOf([&] { file = ReadImage(Path("odd.exr")); }), {"sRGB is assumed"});
    EXPECT_EQ(file.metadata.colorSpace, nullptr);
}

TEST_F(ReadImageFile, ErrorsNameTheFile) {
    ExpectWords(ReadError(Path("missing.png")), {"missing.png: No such"});
    ExpectWords(ReadError(folder_.string()), {"directory"});
    for (const char *name :
         {"broken.png", "broken.exr", "broken.pfm", "broken.hdr", "broken.jpg", "broken.tga", "broken.qoi"})
        ExpectWords(ReadError(Write(name, "this is no image, in spite of its name")), {name});
    ExpectWords(ReadError(Write("s.spd", "400 1\n700 1\n")),
                {Path("s.spd"), "PNG, EXR, PFM, HDR, JPEG, TGA, BMP, GIF, PNM, PSD and TIFF"});
    for (const char *bytes : {"PF\n2 x\n-1\n", "PF\n2 2\n0\n"})
        ExpectWords(ReadError(Write("bad.pfm", bytes)), {"bad.pfm"});
}

TEST_F(ReadImageFile, OfSeveralPartsTheFirstIsReadWithAWarning) {
    const std::vector<std::string> names = {"beauty", "depth", "a name\nof two lines"};
    for (size_t parts = 1; parts <= names.size(); ++parts) {
        const std::string path = Path(std::to_string(parts) + ".exr");
        {
            std::vector<Imf::Header> headers;
            for (size_t i = 0; i < parts; ++i) {
                headers.emplace_back(2, 1);
                headers.back().setName(names[i]);
                headers.back().setType(Imf::SCANLINEIMAGE);
                headers.back().channels().insert("Y", Imf::Channel(Imf::FLOAT));
            }
            Imf::MultiPartOutputFile file(path.c_str(), headers.data(), int(parts));
            for (size_t i = 0; i < parts; ++i) {
                const float values[] = {float(i) + 1, 7};
                Imf::FrameBuffer buffer;
                buffer.insert("Y", Imf::Slice(Imf::FLOAT, reinterpret_cast<char *>(const_cast<float *>(values)), 4, 8));
                Imf::OutputPart part(file, int(i));
                part.setFrameBuffer(buffer);
                part.writePixels(1);
            }
        }
        Image image;
        const std::string messages = StderrOf([&] { image = ReadImage(path).image; });
        EXPECT_EQ(image.Get({0, 0}, 0), 1);
        EXPECT_EQ(image.Get({1, 0}, 0), 7);
        if (parts == 1) {
            EXPECT_EQ(messages, "");
            continue;
        }
        ExpectWords(messages, {path + ": the image has " + std::to_string(parts) + " parts (\"beauty\", \"depth\"",
                               "only the first is read"});
        EXPECT_EQ(std::count(messages.begin(), messages.end(), '\n'), 1) << messages;
    }
}

}  // namespace pbrt::test
