#include <gtest/gtest.h>

#include "pbrt/math/rng.h"
#include "sampler_cases.h"
#include "support/statistics.h"

// Tests what must hold for every sampler.

namespace pbrt::test {
namespace {

class EverySampler : public testing::TestWithParam<SamplerCase> {};
INSTANTIATE_TEST_SUITE_P(All, EverySampler, testing::ValuesIn(RandomizedSamplers()),
                         [](const auto &test) { return test.param.Name(); });

/// The numbers that an integrator draws, in its order.
std::vector<Float> Draw(Sampler &s, Point2i pixel, int index) {
    std::vector<Float> v;
    s.StartPixelSample(pixel, index);
    auto add = [&v](const Point2 &p) {
        v.push_back(p.x);
        v.push_back(p.y);
    };
    add(s.GetPixel2D());
    for (int i = 0; i < 4; ++i) {
        v.push_back(s.Get1D());
        add(s.Get2D());
    }
    return v;
}

TEST_P(EverySampler, ValuesAreBelowOneAndFinite) {
    std::unique_ptr<Sampler> s = GetParam().Make(16);
    for (int y = 0; y < 48; y += 5)
        for (int x = 0; x < 64; x += 3)
            for (int i = 0; i < 40; ++i)  // also beyond the number of samples per pixel
                for (Float u : Draw(*s, {x, y}, i)) ASSERT_TRUE(u >= 0 && u < 1) << u;
}

TEST_P(EverySampler, ManyDimensionsAreThere) {
    std::unique_ptr<Sampler> s = GetParam().Make(4);
    s->StartPixelSample({5, 6}, 2);
    RunningStatistics mean;
    for (int i = 0; i < 3000; ++i) {
        Point2 p = s->Get2D();
        ASSERT_TRUE(p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1) << i;
        mean.Add(double(p.x));
    }
    EXPECT_LT(std::abs(mean.Z(0.5)), 5);
    EXPECT_NEAR(mean.Variance(), 1.0 / 12, 0.01);
}

TEST_P(EverySampler, SamplesDoNotDependOnOrderOrClone) {
    std::unique_ptr<Sampler> a = GetParam().Make(16), b = GetParam().Make(16), c = a->Clone();
    std::vector<std::vector<Float>> forward, backward;
    for (int i = 0; i < 16; ++i) forward.push_back(Draw(*a, {i * 3, i}, i));
    b->StartPixelSample({9, 9}, 3, 40);
    b->Get1D();
    for (int i = 15; i >= 0; --i) {
        EXPECT_EQ(Draw(*b, {i * 3, i}, i), forward[i]);
        EXPECT_EQ(Draw(*c, {i * 3, i}, i), forward[i]);
        EXPECT_EQ(Draw(*c->Clone(), {i * 3, i}, i), forward[i]);
    }
}

TEST_P(EverySampler, DimensionArgumentSkips) {
    std::unique_ptr<Sampler> s = GetParam().Make(16);
    int first = GetParam().pixelOwnsDimensions ? 0 : 2;
    for (int skip : {0, 1, 2, 7}) {
        s->StartPixelSample({3, 4}, 5);
        for (int i = 0; i < skip; ++i) s->Get1D();
        Float a = s->Get1D();
        Point2 b = s->Get2D();
        s->StartPixelSample({3, 4}, 5, first + skip);
        EXPECT_EQ(s->Get1D(), a);
        EXPECT_EQ(s->Get2D(), b);
    }
}

TEST_P(EverySampler, UpcomingNumbersAreThoseDrawnLater) {
    std::unique_ptr<Sampler> s = GetParam().Make(16), untouched = GetParam().Make(16);
    int seen = 0;
    for (int skipped : {0, 1, 2, 5}) {
        s->StartPixelSample({3, 4}, 5);
        untouched->StartPixelSample({3, 4}, 5);
        for (int i = 0; i < 40; ++i) {
            const Point2 *const ahead = s->Upcoming2D(skipped);
            const bool known = ahead;
            const Point2 upcoming = known ? *ahead : Point2(0);
            for (int k = 0; k < skipped; ++k) ASSERT_EQ(s->Get1D(), untouched->Get1D());
            const Point2 drawn = s->Get2D();
            ASSERT_EQ(drawn, untouched->Get2D());
            ASSERT_TRUE(!known || upcoming == drawn) << skipped << ", " << i;
            seen += known;
        }
    }
    EXPECT_GT(seen, 40);
}

TEST_P(EverySampler, NumbersDependOnTheDimensionOnly) {
    // Not on where the sample was started, nor on what was drawn before: numbers are prepared in runs, and these
    // begin elsewhere then.
    std::unique_ptr<Sampler> s = GetParam().Make(16), other = GetParam().Make(16);
    const int first = GetParam().pixelOwnsDimensions ? 0 : 2;
    for (int index : {3, 16 + 5}) {
        constexpr int kDimensions = 150;
        std::vector<Float> one;
        std::vector<Point2> two;
        s->StartPixelSample({7, 2}, index);
        for (int d = 0; d < kDimensions; ++d) one.push_back(s->Get1D());
        for (int d = 0; d < kDimensions; ++d) {
            s->StartPixelSample({7, 2}, index, first + d);
            two.push_back(s->Get2D());
        }
        Rng rng(4);
        for (int i = 0; i < 100; ++i) {
            auto d = size_t(rng.UniformInt(20));
            if (i % 10 == 0) other->StartPixelSample({1, 1}, i % 7);
            other->StartPixelSample({7, 2}, index, first + int(d));
            while (d + 2 <= kDimensions)
                if (rng.UniformInt(2) == 0) {
                    ASSERT_EQ(other->Get1D(), one[d]) << d;
                    d += 1;
                } else {
                    ASSERT_EQ(other->Get2D(), two[d]) << d;
                    d += 2;
                }
        }
    }
}

TEST_P(EverySampler, SeedsPixelsIndicesAndDimensionsDiffer) {
    std::unique_ptr<Sampler> s = GetParam().Make(16, 0), other = GetParam().Make(16, 1);
    auto differ = [](const std::vector<Float> &a, const std::vector<Float> &b) {
        int different = 0;
        for (size_t i = 2; i < a.size(); ++i) different += a[i] != b[i];  // the first two may depend on the pixel only
        return different;
    };
    std::vector<Float> base = Draw(*s, {3, 4}, 5);
    EXPECT_GE(differ(base, Draw(*other, {3, 4}, 5)), 11);
    EXPECT_GE(differ(base, Draw(*s, {4, 4}, 5)), 11);
    EXPECT_GE(differ(base, Draw(*s, {3, 5}, 5)), 11);
    EXPECT_GE(differ(base, Draw(*s, {3, 4}, 6)), 11);
    EXPECT_GE(differ(base, Draw(*s, {3, 4}, 5 + 16)), 11);
    for (size_t i = 3; i < base.size(); ++i) EXPECT_NE(base[i], base[i - 1]);
}

TEST(SkippedSamples, LeaveTheRestOfTheSequence) {
    for (const char *type : {"halton", "sobol"}) {
        const SamplerCase c{type, "", false};
        std::unique_ptr<Sampler> whole = c.Make(16, 1), rest = c.Make(16, 1);
        rest->SkipSamples(16);
        for (int i = 0; i < 16; ++i) EXPECT_EQ(Draw(*rest, {3, 4}, i), Draw(*whole, {3, 4}, 16 + i)) << type;
        EXPECT_EQ(Draw(*rest->WithSeed(1), {3, 4}, 0), Draw(*whole, {3, 4}, 16)) << type;
    }
}

/// Calls f with one sample of every pixel of a square film, for several seeds. Samples of the same pixel share their
/// randomness, but the tests below need samples that are independent (or better stratified).
template <class F>
int ForOneSampleOfEachPixel(const SamplerCase &c, const F &f) {
    int n = 0;
    for (int seed = 0; seed < 5; ++seed) {
        std::unique_ptr<Sampler> s = c.Make(16, seed, {64, 64});
        for (int y = 0; y < 64; ++y)
            for (int x = 0; x < 64; ++x, ++n) f(Draw(*s, {x, y}, int(Hash(x, y, seed) % 16)));
    }
    return n;
}

TEST_P(EverySampler, EveryDimensionIsUniform) {
    constexpr size_t kCells = 64;
    std::vector<std::vector<double>> observed(14, std::vector<double>(kCells, 0));
    int n = ForOneSampleOfEachPixel(GetParam(), [&](const std::vector<Float> &u) {
        ASSERT_EQ(u.size(), observed.size());
        for (size_t d = 0; d < u.size(); ++d) ++observed[d][size_t(u[d] * kCells)];
    });
    std::vector<double> expected(kCells, double(n) / kCells);
    for (size_t d = 0; d < observed.size(); ++d)
        EXPECT_GT(ChiSquareTest(observed[d], expected), SidakAlpha(1e-3, 14 * 11)) << d;
}

TEST_P(EverySampler, PairsOfDimensionsAreJointlyUniform) {
    constexpr size_t kN = 8;
    // Halton dimensions of large bases are known to be correlated until very many samples are taken.
    const size_t dimensions = GetParam().type == "halton" ? 8 : 14;
    std::vector<double> observed(14 * 14 * kN * kN, 0);
    int n = ForOneSampleOfEachPixel(GetParam(), [&](const std::vector<Float> &u) {
        for (size_t a = 0; a < dimensions; ++a)
            for (size_t b = 0; b < a; ++b)
                ++observed[(a * 14 + b) * kN * kN + size_t(u[a] * kN) * kN + size_t(u[b] * kN)];
    });
    std::vector<double> expected(kN * kN, double(n) / (kN * kN));
    for (size_t a = 0; a < dimensions; ++a)
        for (size_t b = 0; b < a; ++b) {
            std::span<const double> cells(&observed[(a * 14 + b) * kN * kN], kN * kN);
            EXPECT_GT(ChiSquareTest(cells, expected), SidakAlpha(1e-3, 91 * 11)) << a << " " << b;
        }
}

/// An integrand over five dimensions with a known mean of 0.
double Integrand(Sampler &s, Point2i pixel, int index) {
    s.StartPixelSample(pixel, index);
    Point2 p = s.GetPixel2D();
    Float a = s.Get1D();
    Point2 q = s.Get2D();
    auto centred = [](Float u) { return double(u) - 0.5; };
    return centred(p.x) * centred(q.y) + std::sin(2 * M_PI * double(a)) + (q.x * q.x + q.y * q.y < 1 ? 1 : 0) -
           M_PI / 4;
}

TEST_P(EverySampler, PixelMeansAreUnbiasedOverSeeds) {
    for (int count : {16, 11}) {
        RunningStatistics error;
        for (int seed = 0; seed < 300; ++seed) {
            std::unique_ptr<Sampler> s = GetParam().Make(count, seed);
            ASSERT_EQ(s->SamplesPerPixel(), count);
            double sum = 0;
            for (int i = 0; i < count; ++i) sum += Integrand(*s, {seed % 64, seed % 48}, i);
            error.Add(sum / count);
        }
        EXPECT_LT(std::abs(error.Z(0)), 4.2) << count;
    }
}

TEST_P(EverySampler, NoneIsWorseThanIndependent) {
    auto variance = [](const SamplerCase &c) {
        double sum = 0;
        std::unique_ptr<Sampler> s = c.Make(64);
        for (int y = 0; y < 48; y += 2)
            for (int x = 0; x < 64; x += 2) {
                double mean = 0;
                for (int i = 0; i < 64; ++i) mean += Integrand(*s, {x, y}, i) / 64;
                sum += mean * mean;
            }
        return sum / (24 * 32);
    };
    double independent = variance({"independent", "", true});
    double factor = GetParam().type == "independent" ? 1.2 : 0.5;
    EXPECT_LT(variance(GetParam()), factor * independent);
}

}  // namespace
}  // namespace pbrt::test
