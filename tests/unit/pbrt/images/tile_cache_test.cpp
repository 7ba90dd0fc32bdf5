#include "pbrt/images/tile_cache.h"

#include <cstring>
#include <random>

#include "image_fixtures.h"
#include "pbrt/core/parallel.h"
#include "pbrt/images/mipmap.h"

namespace pbrt::test {
namespace {

size_t FoldersOfThisProcess() {
    size_t count = 0;
    const std::string mine = "pbrt_textures_" + std::to_string(getpid()) + "_";
    for (const auto &entry : std::filesystem::directory_iterator(std::filesystem::temp_directory_path()))
        count += entry.path().filename().string().starts_with(mine);
    return count;
}

TEST(TileCache, TexelsComeBackAsTheyAre) {
    TileCache cache(8);
    for (PixelFormat format : kFormats)
        for (const std::vector<std::string> &channels : {kGrey, kRgb, kRgba}) {
            const std::vector<Image> images = {NoiseImage(format, {150, 70}, channels),
                                               NoiseImage(format, {3, 65}, channels)};
            const auto stored = cache.Store(images);
            TileCache::Stored::Tile tile;
            const size_t texel = images[0].Bytes() / (150 * 70);
            for (size_t i = 0; i < images.size(); ++i)
                ForEachPixel(images[i], [&](Point2i p) {
                    const char *expected = static_cast<const char *>(images[i].Data()) +
                                           size_t(p.y * images[i].Resolution().x + p.x) * texel;
                    if (!tile.Holds(i, p.x, p.y)) stored->Get(i, p.x, p.y, tile);
                    ASSERT_TRUE(tile.Holds(i, p.x, p.y));
                    ASSERT_EQ(std::memcmp(tile.Texel(p.x, p.y), expected, texel), 0) << i << " " << p.x << " " << p.y;
                });
        }
}

TEST(TileCache, ItsFolderGoesWithIt) {
    const size_t before = FoldersOfThisProcess();
    {
        TileCache cache(8);
        cache.Store({NoiseImage(PixelFormat::U8, {10, 10}, {"Y"})});
        EXPECT_EQ(FoldersOfThisProcess(), before + 1);
    }
    EXPECT_EQ(FoldersOfThisProcess(), before);
}

TEST(TileCache, AMissingFolderOfTemporaryFilesIsAnErrorOfTheUser) {
    const std::string before = std::filesystem::temp_directory_path().string();
    setenv("TMPDIR", "/nonexistent", 1);
    EXPECT_THROW(TileCache(1), UserError);
    setenv("TMPDIR", before.c_str(), 1);
}

TEST(TileCache, MemoryStaysWithinTheLimit) {
    TileCache cache(4);
    const Image image = NoiseImage(PixelFormat::Float, {2048, 1024}, kRgb);  // 25 MB
    const auto stored = cache.Store({image});
    TileCache::Stored::Tile tile;
    for (int y = 0; y < 1024; y += 16)
        for (int x = 0; x < 2048; x += 16) stored->Get(0, x, y, tile);
    EXPECT_GT(cache.Bytes(), 1u << 20);
    EXPECT_LT(cache.Bytes(), 5u << 20);
}

// Fails if OpenImageIO's caches are destroyed while the threads that used them live on.
TEST(TileCache, ThreadsForgetTheCacheBefore) {
    for (int i = 0; i < 30; ++i) {
        TileCache cache(1);
        const Image image = NoiseImage(PixelFormat::Float, {300, 256}, kRgba);
        const auto stored = cache.Store({image});
        const auto *texels = static_cast<const float *>(image.Data());
        ParallelForEach(4, [&](int64_t part) {
            std::mt19937 rng{unsigned(part)};
            for (int k = 0; k < 300; ++k) {
                const int x = int(rng() % 300), y = int(rng() % 256);
                TileCache::Stored::Tile tile;
                stored->Get(0, x, y, tile);
                ASSERT_EQ(std::memcmp(tile.Texel(x, y), texels + (y * 300 + x) * 4, 16), 0)
                    << i << " " << x << " " << y;
            }
        });
    }
}

TEST(TileCache, LookupsAreTheSameBits) {
    for (PixelFormat format : kFormats)
        for (const std::vector<std::string> &channels : {kGrey, kRgb, kRgba})
            for (WrapMode wrap : {WrapMode::Repeat, WrapMode::Clamp, WrapMode::OctahedralSphere}) {
                const Image image = NoiseImage(format, {300, 256}, channels);
                TileCache tiles(1);
                const MipMap memory(image, nullptr, TextureFilter::Point, wrap, 8);
                const MipMap disk(image, nullptr, TextureFilter::Point, wrap, 8, &tiles);
                EXPECT_TRUE(memory.Level(0) && !disk.Level(0));
                EXPECT_EQ(disk.Levels(), memory.Levels());
                for (TextureFilter filter :
                     {TextureFilter::Point, TextureFilter::Bilinear, TextureFilter::Trilinear, TextureFilter::Ewa}) {
                    const MipMap a(memory, filter, 4), b(disk, filter, 4);
                    ParallelForEach(2, [&](int64_t part) {
                        std::mt19937 rng{unsigned(part)};
                        std::uniform_real_distribution<Float> uniform(-0.2f, 1.2f), small(-0.05f, 0.05f);
                        for (int i = 0; i < 60; ++i) {
                            const Point2 st(uniform(rng), uniform(rng));
                            const Vector2 d0(small(rng), small(rng)), d1(small(rng), small(rng));
                            ASSERT_EQ(a.LookupRgb(st, d0, d1), b.LookupRgb(st, d0, d1));
                            ASSERT_EQ(a.LookupFloat(st, d0, d1), b.LookupFloat(st, d0, d1));
                        }
                    });
                }
            }
}

TEST(MipMap, OfTheSameImageFiltersAnew) {
    const Image image = NoiseImage(PixelFormat::U8, {40, 30}, kRgb);
    const MipMap bilinear(image, nullptr, TextureFilter::Bilinear, WrapMode::Clamp, 8);
    const MipMap derived(bilinear, TextureFilter::Ewa, 3);
    const MipMap fresh(image, nullptr, TextureFilter::Ewa, WrapMode::Clamp, 3);
    EXPECT_EQ(derived.Level(0).Data(), bilinear.Level(0).Data());
    const Vector2 d0(.02f, .2f), d1(.01f, .03f);
    for (Float x : {.1f, .37f, .8f}) EXPECT_EQ(derived.LookupRgb({x, .3f}, d0, d1), fresh.LookupRgb({x, .3f}, d0, d1));
}

}  // namespace
}  // namespace pbrt::test
