#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfStandardAttributes.h>

#include <signal.h>

#include <cmath>

#include "image_fixtures.h"
#include "pbrt/images/tile_cache.h"
#include "support/small_files.h"

namespace pbrt::test {

class WriteImageFile : public FolderTest {
  protected:
    /// What is read from the file `name`, to which `image` was written.
    Image ReadBack(const std::string &name, const Image &image, const ImageMetadata &metadata = {}) const {
        WriteImage(Path(name), image, metadata);
        return ReadImage(Path(name)).image;
    }
};

TEST_F(WriteImageFile, ExrKeepsHalfAndFloatExactly) {
    for (PixelFormat format : {PixelFormat::Half, PixelFormat::Float}) {
        const Image image = NoiseImage(format, {37, 21}, kRgb, -3, 1000);
        WriteImage(Path("a.exr"), image);
        const ImageFile file = ReadImage(Path("a.exr"));
        EXPECT_EQ(file.image.Format(), format);
        ExpectSamePixels(file.image, image);
        EXPECT_EQ(file.metadata.colorSpace, nullptr);
        EXPECT_EQ(file.metadata.fullResolution, Point2i(37, 21));
    }
}

TEST_F(WriteImageFile, ExrStoresBytesAsLinearHalf) {
    const Image image = NoiseImage(PixelFormat::U8, {16, 4}, kRgb);
    const Image read = ReadBack("a.exr", image);
    EXPECT_EQ(read.Format(), PixelFormat::Half);
    ExpectSamePixels(read, image, 0.0005f);
}

TEST_F(WriteImageFile, ExrKeepsManyChannelsByName) {
    const std::vector<std::string> names = {"R",        "G",   "B",   "Albedo.R", "Albedo.G",
                                            "Albedo.B", "N.X", "N.Y", "N.Z",      "S0.360,000nm"};
    const Image image = NoiseImage(PixelFormat::Float, {8, 8}, names);
    const Image read = ReadBack("a.exr", image);
    ASSERT_EQ(read.ChannelCount(), image.ChannelCount());
    for (size_t c = 0; c < 3; ++c) EXPECT_EQ(read.Channels()[c], names[c]);
    ExpectSamePixels(read.Extract(names), image);
}

TEST_F(WriteImageFile, ExrKeepsWindowsChromaticitiesAndAttributes) {
    const Image image = NoiseImage(PixelFormat::Half, {10, 6}, kRgb);
    ImageMetadata metadata;
    metadata.pixelBounds = Bounds2i{{5, 3}, {15, 9}};
    metadata.fullResolution = Point2i(40, 30);
    metadata.colorSpace = ColorSpace::Find("rec2020");
    glm::mat4 matrix(1);
    matrix[3] = glm::vec4(7, 8, 9, 1);  // translation
    metadata.attributes["worldToCamera"] = matrix;
    metadata.attributes["samplesPerPixel"] = 64;
    metadata.attributes["renderTimeSeconds"] = 1.5f;
    metadata.attributes["commandLine"] = std::string("pbrt --spp 64 \"a b\".pbrt");
    WriteImage(Path("a.exr"), image, metadata);

    const ImageFile file = ReadImage(Path("a.exr"));
    ExpectSamePixels(file.image, image);
    EXPECT_EQ(file.metadata.pixelBounds->low, Point2i(5, 3));
    EXPECT_EQ(file.metadata.pixelBounds->high, Point2i(15, 9));
    EXPECT_EQ(file.metadata.fullResolution, Point2i(40, 30));
    EXPECT_EQ(file.metadata.colorSpace, ColorSpace::Find("rec2020"));
    EXPECT_EQ(file.metadata.attributes, metadata.attributes);

    // The file's own view: the data window inside the display window, the translation in the last column.
    Imf::InputFile exr(Path("a.exr").c_str());
    EXPECT_EQ(exr.header().dataWindow(), Imath::Box2i({5, 3}, {14, 8}));
    EXPECT_EQ(exr.header().displayWindow(), Imath::Box2i({0, 0}, {39, 29}));
    EXPECT_EQ(exr.header().compression(), Imf::ZIP_COMPRESSION);
    const Imath::M44f m = exr.header().typedAttribute<Imf::M44fAttribute>("worldToCamera").value();
    EXPECT_EQ(m[0][3], 7);
    EXPECT_EQ(m[1][3], 8);
    EXPECT_EQ(m[2][3], 9);
    EXPECT_EQ(m[3][0], 0);
}

TEST_F(WriteImageFile, EveryColorSpaceIsReadBackAndSrgbIsNotStored) {
    for (const std::string &name : ColorSpace::Names()) {
        ImageMetadata metadata;
        metadata.colorSpace = ColorSpace::Find(name);
        WriteImage(Path("a.exr"), NoiseImage(PixelFormat::Half, {4, 4}, kRgb), metadata);
        const ColorSpace *read = ReadImage(Path("a.exr")).metadata.colorSpace;
        EXPECT_EQ(read ? read : &ColorSpace::SRGB(), metadata.colorSpace) << name;
        EXPECT_EQ(Imf::hasChromaticities(Imf::InputFile(Path("a.exr").c_str()).header()),
                  metadata.colorSpace != &ColorSpace::SRGB());
    }
}

TEST_F(WriteImageFile, PngKeepsBytesAndPfmFloats) {
    for (const std::vector<std::string> &names : {kGrey, kRgb, kRgba}) {
        const Image image = NoiseImage(PixelFormat::U8, {13, 9}, names), read = ReadBack("a.png", image);
        EXPECT_EQ(read.Format(), PixelFormat::U8);
        ExpectSamePixels(read, image);
        const Image floats = NoiseImage(PixelFormat::Float, {11, 5}, names, -10, 1e6f);
        if (names.size() < 4) ExpectSamePixels(ReadBack("a.pfm", floats), floats);
    }
}

TEST_F(WriteImageFile, PngIsSrgbAndClampsWithACount) {
    Image image(PixelFormat::Float, {3, 1}, kRgb);
    const Float values[9] = {0, 0.5f, 1, -1, 2, NAN, 0.25f, 0.75f, 0.1f};
    for (int i = 0; i < 9; ++i) image.Set({i / 3, 0}, i % 3, values[i]);
    ExpectWords(StderrOf([&] { WriteImage(Path("clamped.png"), image); }), {"3 of 9"});
    const Image read = ReadImage(Path("clamped.png")).image;
    const Float expected[9] = {0, 0.5f, 1, 0, 1, 0, 0.25f, 0.75f, 0.1f};
    // Half a step of an sRGB byte is at most about 0.0045 in linear values.
    for (int i = 0; i < 9; ++i) EXPECT_NEAR(read.Get({i / 3, 0}, i % 3), expected[i], 0.0046f) << i;
}

TEST_F(WriteImageFile, PlainFormatsConvertToSrgb) {
    ImageMetadata metadata;
    metadata.colorSpace = ColorSpace::Find("rec2020");
    Image image(PixelFormat::Float, {1, 1}, kRgb);
    const Rgb wide(0.2f, 0.3f, 0.25f);
    for (int c = 0; c < 3; ++c) image.Set({0, 0}, c, wide[c]);
    const Image read = ReadBack("a.pfm", image, metadata);
    const Xyz expected = metadata.colorSpace->ToXyz(wide);
    const Xyz got = ColorSpace::SRGB().ToXyz({read.Get({0, 0}, 0), read.Get({0, 0}, 1), read.Get({0, 0}, 2)});
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[c], expected[c], 1e-5f);
}

TEST_F(WriteImageFile, PlainFormatsKeepRgbOfLargerImages) {
    const Image image = NoiseImage(PixelFormat::Float, {4, 4}, {"R", "G", "B", "A", "z"});
    ExpectSamePixels(ReadBack("a.pfm", image), image.Select(kRgb));
    EXPECT_THROW(WriteImage(Path("b.png"), NoiseImage(PixelFormat::Float, {4, 4}, {"u", "v"})), UserError);
    EXPECT_FALSE(std::filesystem::exists(Path("b.png")));
}

TEST_F(WriteImageFile, FailuresLeaveNothingBehind) {
    const Image image = NoiseImage(PixelFormat::Half, {4, 4}, kRgb);
    std::filesystem::create_directory(Path("taken.exr"));
    for (const char *name :
         {"a.tiff", "exr", "no/such/folder/a.exr", "no/such/folder/a.png", "no/such/folder/a.pfm", "taken.exr"})
        EXPECT_THROW(WriteImage(Path(name), image), UserError) << name;
    EXPECT_EQ(FileCount(), 1) << "only the folder is there";
}

TEST_F(WriteImageFile, AFullDiskIsAnErrorAndKeepsTheOldFile) {
    const Image old = NoiseImage(PixelFormat::Float, {2, 2}, kRgb);
    const Image image = NoiseImage(PixelFormat::Float, {64, 64}, kRgb);
    for (const char *name : {"a.exr", "a.png", "a.pfm", "a.jpg"}) {
        WriteImage(Path(name), old);
        const std::string before = ReadFileContents(Path(name));
        {
            const SmallFilesOnly limit(4096);
            EXPECT_THROW(WriteImage(Path(name), image), UserError) << name;
        }
        EXPECT_EQ(ReadFileContents(Path(name)), before) << name;
        WriteImage(Path(name), image);
        EXPECT_GT(ReadFileContents(Path(name)).size(), 4096u) << name << " is too small for the limit of this test";
        std::filesystem::remove(Path(name));
        std::filesystem::create_symlink("/dev/full", Path(name));
        EXPECT_THROW(WriteImage(Path(name), image), UserError) << name;
        std::filesystem::remove(Path(name));
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

TEST_F(WriteImageFile, TilesOnAFullDiskAreAnError) {
    TileCache tiles(8);
    const std::vector<Image> images = {NoiseImage(PixelFormat::Float, {256, 256}, kRgb)};
    // The library writes the description of a file at its end: a limit just below the whole size cuts off only the
    // description.
    for (rlim_t limit : {5000, 400000, 786432 + 100}) {
        const SmallFilesOnly small(limit);
        signal(SIGXFSZ, SIG_IGN);
        EXPECT_THROW(tiles.Store(images), UserError) << limit;
    }
    EXPECT_TRUE(tiles.Store(images));
}

TEST_F(WriteImageFile, ExtensionsMayBeInAnyLetterCase) {
    const Image image = NoiseImage(PixelFormat::Half, {4, 4}, kRgb);
    for (const char *name : {"A.EXR", "b.Png", "c.PFM", "d.JPG"})
        EXPECT_EQ(ReadBack(name, image).Resolution(), Point2i(4, 4)) << name;
}

TEST_F(WriteImageFile, JpegIsSrgbOfHighQuality) {
    Image image(PixelFormat::Float, {32, 32}, kRgba);
    ForEachValue(image, [&](Point2i p, int c) { image.Set(p, c, Float(c < 2 ? p[c] : 16) / 32); });
    const Image read = ReadBack("a.jpg", image);
    ASSERT_EQ(read.ChannelCount(), 3);
    ForEachValue(read, [&](Point2i p, int c) {
        EXPECT_TRUE(std::min(p.x, p.y) < 4 || std::abs(read.Get(p, c) - image.Get(p, c)) < 0.04f) << p.x << " " << p.y;
    });
}

TEST_F(WriteImageFile, WarnsOfValuesTooLargeForHalf) {
    Image image(PixelFormat::Half, {2, 1}, {"Y"});
    image.Set({0, 0}, 0, 1e6f);
    image.Set({1, 0}, 0, 5);
    ExpectWords(StderrOf([&] { WriteImage(Path("bright.exr"), image); }), {"1 values"});
    EXPECT_EQ(ReadImage(Path("bright.exr")).image.Get({0, 0}, 0), 65504);
}

}  // namespace pbrt::test
