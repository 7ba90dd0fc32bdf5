// Files whose headers are wrong, files that end too early, and names that are no files.
#include <OpenImageIO/deepdata.h>
#include <OpenImageIO/imageio.h>

#include <cstring>

#include "image_fixtures.h"

namespace pbrt::test {

namespace {

std::string BigEndian(uint32_t v) { return Bytes({int(v >> 24), int(v >> 16 & 255), int(v >> 8 & 255), int(v & 255)}); }

}  // namespace

class BrokenImage : public FolderTest {
  protected:
    /// Pixels without any pattern, so that no compression makes the file small.
    std::string WriteNoise(const std::string &name, OIIO::TypeDesc type, const std::string &compression = "") {
        OIIO::ImageSpec spec(64, 48, 3, type);
        if (!compression.empty()) spec["compression"] = compression;
        std::vector<float> values(64 * 48 * 3);
        uint32_t state = 1;
        for (float &v : values) v = float((state = state * 1664525u + 1013904223u) >> 8) * 0x1p-24f;
        auto out = OIIO::ImageOutput::create(Path(name));
        EXPECT_TRUE(out && out->open(Path(name), spec) && out->write_image(OIIO::TypeDesc::FLOAT, values.data()) &&
                    out->close())
            << name;
        return ReadFileContents(Path(name));
    }
    /// An EXR of one half channel of 8 x 8 pixels; `attribute`, a window in its header, is overwritten by the wrong
    /// `box`.
    std::string ExrWith(const std::string &attribute, const std::array<int32_t, 4> &box, Imf::Compression compression) {
        Imf::Header header(8, 8);
        header.compression() = compression;
        header.channels().insert("Y", Imf::Channel(Imf::HALF));
        std::vector<char> pixels(8 * 8 * 2);
        WriteExr(Path("small.exr"), header, {{"Y", Imf::Slice(Imf::HALF, pixels.data(), 2, 16)}});
        std::string content = ReadFileContents(Path("small.exr"));
        const std::string name = attribute + std::string("\0box2i\0", 7);
        const size_t at = content.find(name);
        EXPECT_NE(at, std::string::npos);
        std::memcpy(content.data() + at + name.size() + 4, box.data(), sizeof box);
        return Write("lie.exr", content);
    }
};

TEST_F(BrokenImage, AnEarlyEndIsAnErrorInEveryFormat) {
    const OIIO::TypeDesc byte = OIIO::TypeDesc::UINT8, half = OIIO::TypeDesc::HALF, real = OIIO::TypeDesc::FLOAT;
    const struct {
        const char *name;
        OIIO::TypeDesc type;
        const char *compression;
    } kCases[] = {
        {"a.png", byte, ""},          {"deep.png", OIIO::TypeDesc::UINT16, ""},
        {"a.jpg", byte, "jpeg:90"},   {"a.bmp", byte, ""},
        {"a.tga", byte, "none"},      {"runs.tga", byte, "rle"},
        {"a.ppm", byte, ""},          {"a.hdr", real, ""},
        {"a.tif", byte, "none"},      {"zip.tif", byte, "zip"},
        {"a.gif", byte, ""},          {"none.exr", half, "none"},
        {"zip.exr", half, "zip"},     {"zips.exr", real, "zips"},
        {"rle.exr", half, "rle"},     {"piz.exr", half, "piz"},
        {"pxr24.exr", real, "pxr24"}, {"b44.exr", half, "b44"},
        {"dwaa.exr", half, "dwaa"},
    };
    for (const auto &[name, type, compression] : kCases) {
        const std::string whole = WriteNoise(name, type, compression);
        EXPECT_EQ(ReadError(Path(name)), "") << name;
        for (double part : {0.02, 0.2, 0.5, 0.8, 0.9}) {
            const std::string path =
                Write(std::string("cut_") + name, whole.substr(0, size_t(part * double(whole.size()))));
            // libpng would write a line of its own.
            EXPECT_EQ(StderrOf([&] { ExpectWords(ReadError(path), {path}); }), "") << name;
        }
    }
    WriteImage(Path("a.pfm"), NoiseImage(PixelFormat::Float, {16, 8}, kRgb));
    const std::string whole = ReadFileContents(Path("a.pfm"));
    for (size_t size : {size_t(3), size_t(9), whole.size() - 1})
        ExpectWords(ReadError(Write("cut.pfm", whole.substr(0, size))), {"cut.pfm"});
}

TEST_F(BrokenImage, EveryErrorHasAReason) {
    // OpenImageIO gives none for these.
    for (const char *content : {"P6\n2 2\n255\nabc", "P3\n2 2\n255\n1 2 3 4 5", "P5\n2 2\n70000\nabcd"})
        ExpectWords(ReadError(Write("short.ppm", content)), {"short.ppm", "damaged or cut off"});
}

TEST_F(BrokenImage, SizesAreCheckedBeforeMemoryIsAllocated) {
    auto png = [](uint32_t width, uint32_t height) {
        return Bytes({0x89, 'P', 'N', 'G', 13, 10, 26, 10}) + BigEndian(13) + "IHDR" + BigEndian(width) +
               BigEndian(height) + Bytes({8, 2, 0, 0, 0});
    };
    for (const char *size : {"100000 100000", "1048577 1", "1e9 1e9", "2147483648 4", "-1 4", "0 4", "4 0", "nan 1"})
        ExpectWords(ReadError(Write("lie.pfm", std::string("PF\n") + size + "\n-1\nshort")), {"lie.pfm"});
    ExpectWords(ReadError(Write("lie.pfm", "PF\n1000000 1000000\n-1\n")), {"needs about 12 TB of memory"});
    // The checksums are missing: either the sizes are checked first, or the header is an error as a whole.
    for (auto [width, height] :
         {std::pair(100000u, 100000u), {0u, 5u}, {5u, 0u}, {1u << 31, 1u}, {0x7fffffffu, 0x7fffffffu}})
        ExpectWords(ReadError(Write("lie.png", png(width, height))), {"lie.png"});
    for (Imf::Compression compression :
         {Imf::NO_COMPRESSION, Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION, Imf::DWAA_COMPRESSION})
        for (std::array<int32_t, 4> box : {std::array<int32_t, 4>{0, 0, 99999, 99999},
                                           {0, 0, 7, 1 << 30},
                                           {0, 0, 1 << 30, 7},
                                           {5, 5, 3, 3},
                                           {INT32_MIN, INT32_MIN, INT32_MAX, INT32_MAX},
                                           {INT32_MIN, 0, INT32_MIN + 7, 7},
                                           {0, INT32_MAX - 7, 7, INT32_MAX}}) {
            ExpectWords(ReadError(ExrWith("dataWindow", box, compression)), {"lie.exr"});
            if (box[2] == box[0] + 7 && box[3] == box[1] + 7) continue;
            // This file may be readable, but must not crash the program.
            ReadError(ExrWith("displayWindow", box, compression));
        }
    ExpectWords(ReadError(ExrWith("dataWindow", {0, 0, 1 << 20, 7}, Imf::ZIP_COMPRESSION)), {"lie.exr"});
    ExpectWords(ReadError(ExrWith("dataWindow", {0, 0, 59999, 15}, Imf::ZIP_COMPRESSION)), {"60000 x 16 pixels"});
    // A Targa file of 20000 x 20000 pixels in 20 bytes.
    const std::string tga =
        Write("lie.tga", Bytes({0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0x20, 0x4e, 0x20, 0x4e, 24, 0, 1, 2}));
    ExpectWords(ReadError(tga), {"cannot hold"});
}

// OpenEXR combines the samples of a deep pixel into one.
TEST_F(BrokenImage, DeepPixelsBecomeFlat) {
    OIIO::ImageSpec spec(2, 2, 2, OIIO::TypeDesc::FLOAT);
    spec.deep = true;
    spec.channelnames = {"Z", "A"};
    OIIO::DeepData deep(spec);
    for (int p = 0; p < 4; ++p) deep.set_samples(p, 1);
    auto out = OIIO::ImageOutput::create(Path("deep.exr"));
    ASSERT_TRUE(out && out->open(Path("deep.exr"), spec) && out->write_deep_image(deep) && out->close());
    EXPECT_EQ(ReadImage(Path("deep.exr")).image.Resolution(), Point2i(2, 2));
}

TEST_F(BrokenImage, OnlyFilesAreImages) {
    for (const char *name : {"pipe.png", "pipe.exr", "pipe.pfm"}) {
        ASSERT_EQ(mkfifo(Path(name).c_str(), 0600), 0);
        ExpectWords(ReadError(Path(name)), {"is a pipe or a device"});
    }
    std::filesystem::create_symlink("/dev/zero", Path("zero.png"));
    ExpectWords(ReadError(Path("zero.png")), {"is a pipe or a device"});
}

}  // namespace pbrt::test
