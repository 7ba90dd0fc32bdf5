#include "pbrt/images/metrics.h"

#include <cmath>

#include "image_fixtures.h"
#include "pbrt/core/parallel.h"

namespace pbrt::test {

namespace {

Image Flat(Rgb color, Point2i size = {24, 24}) {
    return RgbImage(size, [&](int, int) { return color; });
}

double Flip(const Image &image, const Image &reference, bool hdr = false, Image *errors = nullptr) {
    return FlipReference(reference, hdr).Compare(image, errors);
}

// The reference, in double precision: every filter is a square of weights that is applied at every pixel, and the
// matrices are those of textbooks.
namespace slow {

using Color = glm::dvec3;
constexpr double kPpd = 67, kPi = 3.141592653589793;
const glm::dmat3 kXyzFromRgb = glm::transpose(
    glm::dmat3(0.4124564, 0.3575761, 0.1804375, 0.2126729, 0.7151522, 0.0721750, 0.0193339, 0.1191920, 0.9503041));
const glm::dmat3 kRgbFromXyz = glm::inverse(kXyzFromRgb);
const Color kWhite = kXyzFromRgb * Color(1);

/// A square of weights f(x, y), scaled so that the positive ones add up to 1 and the negative ones to -1.
struct Weights {
    int radius;
    std::vector<double> w;
    double At(int x, int y) const { return w[(y + radius) * (2 * radius + 1) + x + radius]; }
    template <class F>
    Weights(int r, F f) : radius(r) {
        double positive = 0, negative = 0;
        for (int y = -r; y <= r; ++y)
            for (int x = -r; x <= r; ++x) {
                w.push_back(f(x, y));
                (w.back() > 0 ? positive : negative) += std::abs(w.back());
            }
        for (double &v : w) v /= v > 0 ? positive : negative;
    }
};

Weights Contrast(const std::vector<std::pair<double, double>> &terms) {
    return {int(std::ceil(3 * std::sqrt(0.04 / (2 * kPi * kPi)) * kPpd)), [&](int x, int y) {
                const double d2 = (x * x + y * y) / (kPpd * kPpd);
                double sum = 0;
                for (auto [a, b] : terms) sum += a * std::sqrt(kPi / b) * std::exp(-kPi * kPi * d2 / b);
                return sum;
            }};
}

Weights Detector(bool point, bool alongY) {
    const double sigma = 0.5 * 0.082 * kPpd;
    return {int(std::ceil(3 * sigma)), [&](int x, int y) {
                const double g = std::exp(-(x * x + y * y) / (2 * sigma * sigma)), along = alongY ? y : x;
                return point ? (along * along / (sigma * sigma) - 1) * g : -along * g;
            }};
}

using Plane = std::vector<double>;
Plane Apply(const Plane &in, Point2i size, const Weights &k) {
    Plane out(in.size());
    for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x)
            for (int j = -k.radius; j <= k.radius; ++j)
                for (int i = -k.radius; i <= k.radius; ++i)
                    out[y * size.x + x] +=
                        k.At(i, j) * in[std::clamp(y + j, 0, size.y - 1) * size.x + std::clamp(x + i, 0, size.x - 1)];
    return out;
}

double CubeRoot(double t) { return t > 216.0 / 24389 ? std::cbrt(t) : (24389.0 / 27 * t + 16) / 116; }

Color HuntLab(const Color &rgb) {
    const Color c = kXyzFromRgb * rgb / kWhite;
    const double fx = CubeRoot(c.x), fy = CubeRoot(c.y), fz = CubeRoot(c.z), l = 116 * fy - 16;
    return {l, 0.01 * l * 500 * (fx - fy), 0.01 * l * 200 * (fy - fz)};
}

double Distance(const Color &p, const Color &q) { return std::abs(p.x - q.x) + std::hypot(p.y - q.y, p.z - q.z); }

struct Seen {
    std::vector<Color> lab;
    Plane edge, point;
};

Seen See(const Image &image) {
    const Point2i size = image.Resolution();
    Plane yy, cx, cz, lightness;
    ForEachPixel(image, [&](Point2i p) {
        auto v = [&](int c) { return std::clamp(double(image.Get(p, c)), 0.0, 1.0); };
        const Color c = kXyzFromRgb * Color(v(0), v(1), v(2)) / kWhite;
        yy.push_back(116 * c.y - 16);
        cx.push_back(500 * (c.x - c.y));
        cz.push_back(200 * (c.y - c.z));
        lightness.push_back(c.y);
    });
    Seen out;
    yy = Apply(yy, size, Contrast({{1, 0.0047}}));
    cx = Apply(cx, size, Contrast({{1, 0.0053}}));
    cz = Apply(cz, size, Contrast({{34.1, 0.04}, {13.5, 0.025}}));
    for (size_t i = 0; i < yy.size(); ++i) {
        const double y = (yy[i] + 16) / 116;
        const Color xyz = kWhite * Color(y + cx[i] / 500, y, y - cz[i] / 200);
        out.lab.push_back(HuntLab(glm::clamp(kRgbFromXyz * xyz, 0.0, 1.0)));
    }
    auto length = [&](bool point) {
        const Plane a = Apply(lightness, size, Detector(point, false)),
                    b = Apply(lightness, size, Detector(point, true));
        Plane l;
        for (size_t i = 0; i < a.size(); ++i) l.push_back(std::hypot(a[i], b[i]));
        return l;
    };
    out.edge = length(false);
    out.point = length(true);
    return out;
}

Plane Flip(const Image &image, const Image &reference) {
    const Seen r = See(reference), t = See(image);
    const double largest = std::pow(Distance(HuntLab({0, 1, 0}), HuntLab({0, 0, 1})), 0.7);
    Plane out;
    for (size_t i = 0; i < r.lab.size(); ++i) {
        const double d = std::pow(Distance(r.lab[i], t.lab[i]), 0.7);
        const double knee = 0.4 * largest;
        const double color = d < knee ? 0.95 * d / knee : 0.95 + 0.05 * (d - knee) / (largest - knee);
        const double feature =
            std::sqrt(std::max(std::abs(r.edge[i] - t.edge[i]), std::abs(r.point[i] - t.point[i])) / std::sqrt(2.0));
        out.push_back(std::pow(color, 1 - feature));
    }
    return out;
}

}  // namespace slow

// A picture of smooth colours with edges, some noise and, if `dots`, dots.
Image Picture(float phase, bool dots) {
    const Image noise = NoiseImage(PixelFormat::Float, {37, 29}, kRgb, -0.1f, 0.1f);
    return RgbImage({37, 29}, [&](int x, int y) {
        Rgb c(0.5f + 0.4f * std::sin(0.3f * float(x) + phase), x > 18 ? 0.8f : 0.2f,
              0.5f + 0.5f * std::cos(0.2f * float(y) - phase));
        for (int i = 0; i < 3; ++i) c[i] = std::max(0.f, c[i] + noise.Get({x, y}, i));
        if (dots && x % 11 == 5 && y % 7 == 3) c = Rgb(1.3f, 1, 0.9f);
        return c;
    });
}

}  // namespace

TEST(Flip, AgreesWithTheDirectConvolution) {
    const Image reference = Picture(0, false), image = Picture(0.4f, true);
    Image errors;
    const double mean = Flip(image, reference, false, &errors);
    const slow::Plane expected = slow::Flip(image, reference);
    double sum = 0, worst = 0;
    ForEachPixel(errors, [&](Point2i p) {
        const double e = expected[p.y * 37 + p.x];
        sum += e;
        worst = std::max(worst, std::abs(e - double(errors.Get(p, 0))));
    });
    EXPECT_LT(worst, 2e-3);
    EXPECT_NEAR(mean, sum / (29 * 37), 3e-4);
    EXPECT_GT(mean, 0.1);
}

TEST(Flip, IsZeroForEqualImagesAndSymmetric) {
    const Image a = Picture(0, false), b = Picture(1, true);
    EXPECT_EQ(Flip(a, a), 0);
    EXPECT_EQ(Flip(a, a, true), 0);
    EXPECT_DOUBLE_EQ(Flip(a, b), Flip(b, a));
    EXPECT_GT(Flip(a, b), 0);
}

TEST(Flip, StaysBetweenZeroAndOne) {
    const Image a = NoiseImage(PixelFormat::Float, {31, 23}, kRgb, -1, 3);
    const Image b = RgbImage({31, 23}, [](int x, int y) { return (x / 3 + y / 5) % 2 ? Rgb(0, 9, 0) : Rgb(0, 0, 1); });
    for (bool hdr : {false, true}) {
        Image errors;
        Flip(a, b, hdr, &errors);
        ForEachPixel(errors, [&](Point2i p) {
            EXPECT_GE(errors.Get(p, 0), 0);
            EXPECT_LE(errors.Get(p, 0), 1);
        });
    }
}

// Pictures of one colour have no features, and the filters do not change them. Lab of green is 87.73 -86.18 83.18, of
// blue 32.30 79.19 -107.86; with Hunt's factor their distance is 203.3, and 203.3^0.7 = 41.27.
TEST(Flip, OfFlatColorsIsTheRemappedColorDistance) {
    // For black and white, 100^0.7 / 41.27 = 0.6087 is above the knee: 0.95 + 0.05 (0.6087 - 0.4) / 0.6.
    EXPECT_NEAR(Flip(Flat({0, 0, 0}), Flat({1, 1, 1})), 0.9674, 2e-4);
    EXPECT_NEAR(Flip(Flat({0, 1, 0}), Flat({0, 0, 1})), 1, 1e-4);
    // Greys of lightness 50 and 60 have Y = ((L + 16) / 116)^3; 10^0.7 / 41.27 = 0.12145 is below the knee.
    const auto grey = [](double lightness) { return Rgb(float(std::pow((lightness + 16) / 116, 3))); };
    EXPECT_NEAR(Flip(Flat(grey(50)), Flat(grey(60))), 0.12145 * 0.95 / 0.4, 2e-4);
    // What the screen cannot show counts only for HDR-FLIP.
    EXPECT_EQ(Flip(Flat(Rgb(4)), Flat(Rgb(2))), 0);
    EXPECT_GT(Flip(Flat(Rgb(4)), Flat(Rgb(2)), true), 0.05);
}

TEST(HdrFlip, DoesNotChangeWhenBothPicturesAreScaled) {
    auto scaled = [](const Image &in, float factor) {
        Image out = in;
        for (size_t i = 0; i < out.ValueCount(); ++i) static_cast<float *>(out.Data())[i] *= factor;
        return out;
    };
    const Image a = Picture(0.3f, true), b = Picture(0, false);
    const double one = Flip(a, b, true);
    for (float factor : {0.015625f, 32.f}) EXPECT_NEAR(Flip(scaled(a, factor), scaled(b, factor), true), one, 1e-5);
    EXPECT_GT(one, 0.05);
}

// For the largest luminance 16 and the median 1: the tone curve reaches 0.85 at x with (0.9036 - 0.85 0.8748) x^2 +
// (0.018 - 0.85 0.354) x - 0.85 0.14 = 0, so x = 2.1189.
TEST(HdrFlip, ExposuresReachFromTheBrightestValueToTheMedian) {
    const Image image = RgbImage({10, 10}, [](int x, int y) { return Rgb(x == 3 && y == 4 ? 16.f : 1.f); });
    const double x = 2.1189;
    ASSERT_NEAR((0.9036 - 0.85 * 0.8748) * x * x + (0.018 - 0.85 * 0.354) * x - 0.85 * 0.14, 0, 1e-4);
    const std::vector<double> exposures = FlipReference(image, true).Exposures();
    ASSERT_GE(exposures.size(), 4u);
    ASSERT_LE(exposures.size(), 5u);
    EXPECT_NEAR(exposures.front(), std::log2(x / 16), 1e-3);
    EXPECT_NEAR(exposures.back(), std::log2(x), 1e-3);
    EXPECT_EQ(FlipReference(Flat({0, 0, 0}), true).Exposures().size(), 1u);
    EXPECT_EQ(FlipReference(Flat({3, 3, 3}), true).Exposures().size(), 1u);
    EXPECT_TRUE(FlipReference(image).Exposures().empty());
}

TEST(Flip, DoesNotDependOnTheNumberOfThreads) {
    const Image a = Picture(0, false), b = Picture(1, true);
    auto with = [&](int threads) {
        ThreadLimit limit(threads);
        return Flip(a, b, true);
    };
    EXPECT_EQ(with(1), with(3));
}

TEST(Flip, ThrowsIfImagesCannotBeCompared) {
    const Image grey(PixelFormat::Float, {4, 4}, {"Y"});
    EXPECT_THROW(FlipReference{grey}, UserError);
    EXPECT_THROW(Flip(Flat({1, 1, 1}, {5, 4}), Flat({1, 1, 1}, {4, 5})), UserError);
    EXPECT_THROW(Flip(grey, Flat({1, 1, 1}, {4, 4})), UserError);
}

TEST(Flip, CountsInvalidValuesAndTakesThemAsBlack) {
    Image image = Flat({0.5f, 0.5f, 0.5f}), black = image;
    for (int c = 0; c < 3; ++c) {
        image.Set({7, 7}, c, NAN);
        black.Set({7, 7}, c, 0);
    }
    size_t skipped = 0;
    const Image reference = Flat({0.5f, 0.5f, 0.5f});
    EXPECT_EQ(ImageError(image, reference, Metric::FLIP, nullptr, &skipped), Flip(black, reference));
    EXPECT_EQ(skipped, 3u);
}

}  // namespace pbrt::test
