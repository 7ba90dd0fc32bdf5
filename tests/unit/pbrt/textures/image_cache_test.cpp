#include "pbrt/textures/image_texture.h"

#include "support/folder_test.h"

namespace pbrt {
namespace {

class ImageCacheTest : public test::FolderTest {
  protected:
    void SetUp() override {
        Image image(PixelFormat::U8, {256, 256}, {"R", "G", "B"});
        ForEachValue(image,
                     [&](Point2i p, int c) { image.Set(p, c, Float((p.x * 7 + p.y * 13 + c * 50) % 256) / 256); });
        WriteImage(key_.path, image);
    }
    MipMapKey With(TextureFilter filter, Float maxAnisotropy = 8) const {
        MipMapKey key = key_;
        key.filter = filter;
        key.maxAnisotropy = maxAnisotropy;
        return key;
    }
    MipMapKey key_{.path = Path("image.png")};
};

TEST_F(ImageCacheTest, FiltersShareThePixels) {
    for (bool preload : {false, true}) {
        ImageCache cache;
        const std::vector<MipMapKey> keys = {With(TextureFilter::Ewa), With(TextureFilter::Bilinear),
                                             With(TextureFilter::Point), With(TextureFilter::Ewa, 2)};
        if (preload) cache.Preload(keys);
        for (const MipMapKey &key : keys)
            EXPECT_EQ(cache.GetMipMap(key)->Level(0).Data(), cache.GetMipMap(keys[0])->Level(0).Data());
        MipMapKey wrapped = keys[0], decoded = keys[0];
        wrapped.wrap = WrapMode::Clamp;
        decoded.encoding = ColorEncoding{ColorEncoding::Kind::Linear};
        EXPECT_NE(cache.GetMipMap(wrapped)->Level(0).Data(), cache.GetMipMap(keys[0])->Level(0).Data());
        EXPECT_NE(cache.GetMipMap(decoded)->Level(0).Data(), cache.GetMipMap(keys[0])->Level(0).Data());
    }
}

TEST_F(ImageCacheTest, TheLimitChangesWhereTexelsAreAndNotWhatTheyAre) {
    ImageCache memory, disk(1);
    const auto a = memory.GetMipMap(With(TextureFilter::Ewa)), b = disk.GetMipMap(With(TextureFilter::Ewa));
    EXPECT_TRUE(a->Level(0) && !b->Level(0));
    for (Float x = 0; x < 1; x += .07f)
        EXPECT_EQ(a->LookupRgb({x, .4f}, {.01f, 0}, {0, .02f}), b->LookupRgb({x, .4f}, {.01f, 0}, {0, .02f}));
}

TEST_F(ImageCacheTest, AMissingFileFailsForEveryFilter) {
    ImageCache cache;
    key_.path += ".none";
    EXPECT_THROW(cache.GetMipMap(With(TextureFilter::Ewa)), UserError);
    EXPECT_THROW(cache.GetMipMap(With(TextureFilter::Point)), UserError);
    EXPECT_THROW(cache.GetMipMap(With(TextureFilter::Point)), UserError);
}

}  // namespace
}  // namespace pbrt
