#include "pbrt/images/mipmap.h"

#include <cmath>
#include <random>

#include "image_fixtures.h"

namespace pbrt::test {

namespace {

constexpr TextureFilter AllFilters[] = {TextureFilter::Point, TextureFilter::Bilinear, TextureFilter::Trilinear,
                                        TextureFilter::Ewa};
constexpr WrapMode AllWraps[] = {WrapMode::Repeat, WrapMode::Black, WrapMode::Clamp, WrapMode::OctahedralSphere};

// The reference functions work in double precision on the pixels of a level, through Image::Get with its wrap modes.
double SlowBilinear(const Image &image, Point2 st, int channel, WrapMode wrap) {
    const double x = double(st.x) * image.Resolution().x - 0.5, y = double(st.y) * image.Resolution().y - 0.5;
    double sum = 0;
    for (int dy = -1; dy <= 2; ++dy)
        for (int dx = -1; dx <= 2; ++dx) {
            const int px = int(std::floor(x)) + dx, py = int(std::floor(y)) + dy;
            const double w = std::max(0.0, 1 - std::abs(x - px)) * std::max(0.0, 1 - std::abs(y - py));
            if (w > 0) sum += w * double(image.Get({px, py}, channel, wrap));
        }
    return sum;
}

// The Gaussian-weighted mean of all pixels p with q(p) < 1, where q is the quadratic form of the inverse of J J^T + I,
// and the columns of J are the footprint axes, in pixels.
double SlowEllipse(const Image &image, Point2 st, Vector2 axis0, Vector2 axis1, int channel, WrapMode wrap) {
    const double w = image.Resolution().x, h = image.Resolution().y;
    const double cx = double(st.x) * w - 0.5, cy = double(st.y) * h - 0.5;
    const double ux = double(axis0.x) * w, uy = double(axis0.y) * h, vx = double(axis1.x) * w, vy = double(axis1.y) * h;
    const double xx = ux * ux + vx * vx + 1, xy = ux * uy + vx * vy, yy = uy * uy + vy * vy + 1;
    const double det = xx * yy - xy * xy;
    const int reach = int(std::sqrt(std::max(xx, yy))) + 2;
    double sum = 0, weights = 0;
    for (int y = int(std::floor(cy)) - reach; y <= cy + reach; ++y)
        for (int x = int(std::floor(cx)) - reach; x <= cx + reach; ++x) {
            const double dx = x - cx, dy = y - cy;
            const double q = (yy * dx * dx - 2 * xy * dx * dy + xx * dy * dy) / det;
            if (q >= 1) continue;
            const double weight = std::exp(-2 * q) - std::exp(-2.0);
            sum += weight * double(image.Get({x, y}, channel, wrap));
            weights += weight;
        }
    return sum / weights;
}

struct Query {
    Point2 st;
    Vector2 dst0, dst1;
};

std::vector<Query> RandomQueries(int count, double smallest, double largest) {
    std::mt19937 rng(7);
    auto uniform = [&](double a, double b) { return a + (b - a) * (double(rng()) / 4294967296.0); };
    std::vector<Query> queries;
    for (int i = 0; i < count; ++i) {
        auto axis = [&] {
            const double length = std::exp(uniform(std::log(smallest), std::log(largest))),
                         angle = uniform(0, 6.2831853);
            return Vector2(length * std::cos(angle), length * std::sin(angle));
        };
        queries.push_back({Point2(uniform(-0.9, 1.9), uniform(-0.9, 1.9)), axis(), axis()});
    }
    return queries;
}

/// The level of bilinear and trilinear lookups: 0 is the finest; fractions, and below 0.
double LevelFor(const MipMap &map, const Query &q) {
    const Vector2 a = glm::abs(q.dst0), b = glm::abs(q.dst1);
    return map.Levels() - 1 + std::log2(2 * double(std::max({a.x, a.y, b.x, b.y})));
}

/// The tent of the level below a fractional one.
double SlowLevel(const MipMap &map, double level, Point2 st, int channel, WrapMode wrap) {
    if (level >= map.Levels() - 1) return double(map.Level(map.Levels() - 1).Get({0, 0}, channel));
    return SlowBilinear(map.Level(std::max(0, int(std::floor(level)))), st, channel, wrap);
}

MipMap MapOf(const Image &image, TextureFilter filter, WrapMode wrap = WrapMode::Repeat, Float anisotropy = 8) {
    return {image, nullptr, filter, wrap, anisotropy};
}

}  // namespace

TEST(Pyramid, LevelsAreMeansOfTheirSquares) {
    for (Point2i size : {Point2i(16, 16), Point2i(8, 32), Point2i(64, 1), Point2i(1, 4), Point2i(1, 1)}) {
        const Image image = NoiseImage(PixelFormat::Float, size, kRgb);
        const std::vector<Image> levels = BuildPyramid(image, WrapMode::Repeat);
        ASSERT_EQ(levels.size(), 1 + size_t(std::log2(std::max(size.x, size.y))));
        ExpectSamePixels(levels[0], image);
        for (size_t level = 1; level < levels.size(); ++level) {
            const Point2i coarse = levels[level].Resolution(), block = size / coarse;
            EXPECT_EQ(coarse, glm::max(Point2i(1), Point2i(size.x >> level, size.y >> level)));
            ForEachPixel(levels[level], [&](Point2i p) {
                double sum = 0;
                for (int v = 0; v < block.y; ++v)
                    for (int u = 0; u < block.x; ++u) sum += double(image.Get(p * block + Point2i(u, v), 1));
                ASSERT_NEAR(levels[level].Get(p, 1), sum / (block.x * block.y), 1e-6);
            });
        }
        EXPECT_EQ(levels.back().Resolution(), Point2i(1));
    }
}

TEST(Pyramid, KeepsFormatAndEncodingInEveryLevel) {
    for (PixelFormat format : kFormats)
        for (Point2i size : {Point2i(16, 8), Point2i(11, 5)}) {
            const ColorEncoding encoding = *ColorEncoding::Parse("gamma 1.8");
            for (const Image &level : BuildPyramid(NoiseImage(format, size, {"Y"}, 0, 1, encoding), WrapMode::Clamp)) {
                EXPECT_EQ(level.Format(), format);
                EXPECT_TRUE(format != PixelFormat::U8 || level.Encoding() == encoding);
            }
        }
}

TEST(Pyramid, EnlargesOtherSizesToPowersOfTwo) {
    const std::vector<Image> levels = BuildPyramid(NoiseImage(PixelFormat::Float, {48, 20}, {"Y"}), WrapMode::Repeat);
    EXPECT_EQ(levels[0].Resolution(), Point2i(64, 32));
    EXPECT_EQ(levels.size(), 7u);
    // A constant image stays constant, even at its edges.
    Image flat(PixelFormat::Float, {5, 7}, {"Y"});
    Fill(flat, 0, 0.3f);
    for (WrapMode wrap : {WrapMode::Repeat, WrapMode::Clamp, WrapMode::OctahedralSphere}) {
        const Image enlarged = BuildPyramid(flat, wrap)[0];
        ForEachPixel(enlarged, [&](Point2i p) { EXPECT_NEAR(enlarged.Get(p, 0), 0.3f, 1e-6f); });
    }
}

TEST(Pyramid, EnlargingIsTheLanczosSum) {
    const Image image = NoiseImage(PixelFormat::Float, {6, 4}, {"Y"}, 0, 1);
    auto sinc = [](double x) { return std::abs(x) < 1e-9 ? 1 : std::sin(M_PI * x) / (M_PI * x); };
    auto lanczos = [&](double x) { return std::abs(x) >= 2 ? 0 : sinc(x) * sinc(x / 2); };
    for (WrapMode wrap : AllWraps) {
        const Image enlarged = BuildPyramid(image, wrap)[0];
        ASSERT_EQ(enlarged.Resolution(), Point2i(8, 4));
        ForEachPixel(enlarged, [&](Point2i p) {
            const double center = (p.x + 0.5) * 6 / 8;
            double sum = 0, weights = 0;
            for (int i = -4; i < 12; ++i) {
                sum += lanczos(i + 0.5 - center) * double(image.Get({i, p.y}, 0, wrap));
                weights += lanczos(i + 0.5 - center);
            }
            EXPECT_NEAR(enlarged.Get(p, 0), std::max(0.0, sum / weights), 2e-5) << p.x << " " << p.y;
        });
    }
}

TEST(MipMap, BilinearIsTheTentOfTheLevelForTheFootprint) {
    for (PixelFormat format : kFormats)
        for (WrapMode wrap : AllWraps) {
            const MipMap map = MapOf(NoiseImage(format, {32, 16}, kRgb), TextureFilter::Bilinear, wrap);
            for (const Query &q : RandomQueries(300, 0.002, 0.4)) {
                const Rgb got = map.LookupRgb(q.st, q.dst0, q.dst1);
                for (int c = 0; c < 3; ++c) ASSERT_NEAR(got[c], SlowLevel(map, LevelFor(map, q), q.st, c, wrap), 1e-5);
            }
        }
}

TEST(MipMap, PointTakesTheNearestTexelOfTheLevel) {
    const MipMap map = MapOf(NoiseImage(PixelFormat::Float, {32, 16}, kRgb), TextureFilter::Point);
    for (const Query &q : RandomQueries(300, 0.002, 0.3)) {
        const double level = LevelFor(map, q);
        if (level >= map.Levels() - 1) continue;
        const Image &image = map.Level(std::max(0, int(std::floor(level))));
        const Point2i p(int(std::floor(q.st.x * Float(image.Resolution().x))),
                        int(std::floor(q.st.y * Float(image.Resolution().y))));
        for (int c = 0; c < 3; ++c)
            EXPECT_EQ(map.LookupRgb(q.st, q.dst0, q.dst1)[c], image.Get(p, c, WrapMode::Repeat));
    }
}

TEST(MipMap, TrilinearBlendsTwoLevelsAboveTheFinest) {
    for (PixelFormat format : {PixelFormat::U8, PixelFormat::Float}) {
        const MipMap map = MapOf(NoiseImage(format, {64, 64}, kRgb), TextureFilter::Trilinear, WrapMode::Clamp);
        int blended = 0;
        for (const Query &q : RandomQueries(400, 0.001, 0.4)) {
            const double level = LevelFor(map, q), t = level < 1 ? 0 : level - std::floor(level);
            blended += t > 0 && level < map.Levels() - 1;
            for (int c = 0; c < 3; ++c) {
                const auto at = [&](double l) { return SlowLevel(map, l, q.st, c, WrapMode::Clamp); };
                const double expected = level < 1 ? at(0) : (1 - t) * at(level) + t * at(level + 1);
                ASSERT_NEAR(map.LookupRgb(q.st, q.dst0, q.dst1)[c], expected, 2e-5);
            }
        }
        EXPECT_GT(blended, 100);
    }
}

TEST(MipMap, EwaIsTheGaussianMeanOverTheEllipse) {
    // Below 1 the shorter axis becomes the longer one.
    for (const Float anisotropy : {Float(5), Float(0.6)})
        for (WrapMode wrap : AllWraps) {
            const MipMap map =
                MapOf(NoiseImage(PixelFormat::Float, {64, 32}, kRgb), TextureFilter::Ewa, wrap, anisotropy);
            int between = 0;
            for (const Query &q : RandomQueries(200, 0.003, 0.5)) {
                Vector2 major = q.dst0, minor = q.dst1;
                if (glm::length(major) < glm::length(minor)) std::swap(major, minor);
                double shorter = double(glm::length(minor));
                const double least = double(glm::length(major)) / double(anisotropy);
                if (shorter < least) {
                    minor *= Float(least / shorter);
                    shorter = least;
                }
                const double level = std::max(0.0, map.Levels() - 1 + std::log2(shorter));
                const int whole = int(std::floor(level));
                auto at = [&](int i) {
                    if (i >= map.Levels()) return double(map.Level(map.Levels() - 1).Get({0, 0}, 1));
                    return SlowEllipse(map.Level(i), q.st, major, minor, 1, wrap);
                };
                const double t = level - whole, expected = (1 - t) * at(whole) + t * at(whole + 1);
                between += whole > 0;
                // The tolerance: the weights come from a table of 128 steps over a range of 0.865.
                ASSERT_NEAR(map.LookupRgb(q.st, q.dst0, q.dst1).y, expected, 0.01);
            }
            EXPECT_GT(between, 50);
        }
}

TEST(MipMap, EwaWithoutWidthIsBilinear) {
    const MipMap map = MapOf(NoiseImage(PixelFormat::Float, {32, 32}, kRgb), TextureFilter::Ewa);
    for (const Query &q : RandomQueries(50, 0.01, 0.1)) {
        const double expected = SlowBilinear(map.Level(0), q.st, 0, WrapMode::Repeat);
        EXPECT_NEAR(map.LookupRgb(q.st, q.dst0, {0, 0}).x, expected, 1e-5);
        EXPECT_NEAR(map.LookupRgb(q.st, {0, 0}, {0, 0}).x, expected, 1e-5);
    }
}

TEST(MipMap, FiltersKeepConstantImages) {
    Image flat(PixelFormat::Float, {32, 16}, kRgb);
    for (int c = 0; c < 3; ++c) Fill(flat, c, 0.25f * Float(c + 1));
    for (TextureFilter filter : AllFilters)
        for (WrapMode wrap : {WrapMode::Repeat, WrapMode::Clamp, WrapMode::OctahedralSphere}) {
            const MipMap map = MapOf(flat, filter, wrap);
            for (const Query &q : RandomQueries(100, 1e-4, 10)) {
                const Rgb got = map.LookupRgb(q.st, q.dst0, q.dst1);
                for (int c = 0; c < 3; ++c) ASSERT_NEAR(got[c], 0.25f * Float(c + 1), 1e-5f);
            }
        }
}

TEST(MipMap, FloatLookupsFollowTheChannelRules) {
    const Point2 st(0.3f, 0.6f);
    const Vector2 a(0.02f, 0), b(0, 0.02f), none(0, 0), wide(2, 0);
    auto lookup = [&](const Image &image, TextureFilter filter, Vector2 d0, Vector2 d1) {
        return MapOf(image, filter).LookupFloat(st, d0, d1);
    };
    const Image grey = NoiseImage(PixelFormat::Float, {16, 16}, {"Y"});
    const Image rgb = NoiseImage(PixelFormat::Float, {16, 16}, kRgb);
    const Image rgba = NoiseImage(PixelFormat::Float, {16, 16}, kRgba);
    for (TextureFilter filter : {TextureFilter::Bilinear, TextureFilter::Trilinear}) {
        EXPECT_EQ(lookup(rgba, filter, a, b), lookup(rgba.Extract({"A"}), filter, a, b));
        EXPECT_NEAR(lookup(rgb, filter, a, b),
                    (lookup(rgb.Extract({"R"}), filter, a, b) + lookup(rgb.Extract({"G"}), filter, a, b) +
                     lookup(rgb.Extract({"B"}), filter, a, b)) /
                        3,
                    1e-6f);
        // A footprint as wide as the image takes the first channel.
        EXPECT_EQ(lookup(rgba, filter, wide, b), lookup(rgba.Extract({"R"}), filter, wide, b));
    }
    for (TextureFilter filter : {TextureFilter::Point, TextureFilter::Ewa}) {
        EXPECT_EQ(lookup(rgba, filter, a, b), lookup(rgba.Extract({"R"}), filter, a, b));
        EXPECT_EQ(lookup(rgb, filter, a, b), lookup(rgb.Extract({"R"}), filter, a, b));
    }
    EXPECT_EQ(lookup(rgba, TextureFilter::Ewa, a, none), lookup(rgba.Extract({"A"}), TextureFilter::Ewa, a, none));
    const MipMap map = MapOf(grey, TextureFilter::Bilinear);
    EXPECT_EQ(map.LookupRgb(st, a, b), Rgb(map.LookupFloat(st, a, b)));
}

TEST(MipMap, KeepsAlphaOnlyIfItIsNotOneEverywhere) {
    Image image = NoiseImage(PixelFormat::U8, {8, 8}, kRgba);
    EXPECT_EQ(MapOf(image, TextureFilter::Bilinear).Level(0).ChannelCount(), 4);
    Fill(image, 3, 1);
    EXPECT_EQ(MapOf(image, TextureFilter::Bilinear).Level(0).ChannelCount(), 3);
    // The channels of an EXR file come in any order, with others between them.
    const Image exr = NoiseImage(PixelFormat::Half, {8, 8}, {"B", "depth", "G", "R"});
    const MipMap map(exr, ColorSpace::Find("rec2020"), TextureFilter::Bilinear, WrapMode::Repeat, 8);
    EXPECT_EQ(map.Level(0).Channels(), kRgb);
    EXPECT_EQ(&map.Space(), ColorSpace::Find("rec2020"));
    EXPECT_THROW(MapOf(NoiseImage(PixelFormat::Half, {8, 8}, {"u", "v"}), TextureFilter::Bilinear), UserError);
}

TEST(MipMap, StrangeFootprintsAndPositionsStayFinite) {
    const Float inf = Infinity, nan = std::numeric_limits<Float>::quiet_NaN();
    for (TextureFilter filter : AllFilters)
        for (WrapMode wrap : AllWraps) {
            const MipMap map = MapOf(NoiseImage(PixelFormat::U8, {16, 16}, kRgb), filter, wrap);
            for (Vector2 d :
                 {Vector2(0), Vector2(inf, 0), Vector2(nan, nan), Vector2(1e30f, 1e-30f), Vector2(1e-30f, 1e-38f)})
                for (Point2 st : {Point2(0.5f, 0.5f), Point2(1e8f, -1e8f), Point2(-1e30f, 1e30f)}) {
                    const Rgb v = map.LookupRgb(st, d, {d.y, d.x});
                    for (int c = 0; c < 3; ++c) EXPECT_TRUE(v[c] >= 0 && v[c] <= 1.001f) << v[c];
                }
        }
}

}  // namespace pbrt::test
