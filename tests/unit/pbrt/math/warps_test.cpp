#include "pbrt/math/warps.h"

#include <gtest/gtest.h>

#include <functional>

#include "pbrt/math/rng.h"
#include "support/statistics.h"

namespace pbrt {
namespace {

constexpr int kDraws = 200000;

double Flat(double, double) { return 1; }

/// p-value of a chi-square test of sample(u), mapped to the unit square and counted in nx * ny cells, against the
/// integral of the density.
double SquareTest(const std::function<Point2(const Point2 &)> &sample,
                  const std::function<double(double, double)> &density) {
    constexpr int kN = 12, kSub = 8;
    Rng rng(17);
    std::vector<double> observed(kN * kN, 0), expected(kN * kN, 0);
    for (int i = 0; i < kDraws; ++i) {
        Point2 p = sample(rng.Uniform2());
        auto x = std::clamp(int(p.x * kN), 0, kN - 1), y = std::clamp(int(p.y * kN), 0, kN - 1);
        ++observed[size_t(y * kN + x)];
    }
    for (int y = 0; y < kN * kSub; ++y)
        for (int x = 0; x < kN * kSub; ++x)
            expected[size_t(y / kSub * kN + x / kSub)] +=
                kDraws * density((x + 0.5) / (kN * kSub), (y + 0.5) / (kN * kSub)) / (kN * kSub) / (kN * kSub);
    return test::ChiSquareTest(observed, expected);
}

Float Azimuth01(Float y, Float x) {
    Float phi = std::atan2(y, x) * Inv2Pi;
    return phi < 0 ? phi + 1 : phi;
}
/// Area-preserving coordinates of the sphere.
Point2 SphereCell(const Vector3 &w) { return {(w.z + 1) / 2, Azimuth01(w.y, w.x)}; }

TEST(Warps, DisksAreUniformByArea) {
    auto cell = [](const Point2 &p) { return Point2(p.x * p.x + p.y * p.y, Azimuth01(p.y, p.x)); };
    EXPECT_GT(SquareTest([&](const Point2 &u) { return cell(SampleUniformDiskConcentric(u)); }, Flat), 1e-4);
    EXPECT_EQ(SampleUniformDiskConcentric({0.5f, 0.5f}), Point2(0, 0));
}

TEST(Warps, ConcentricDiskKeepsNeighboursTogether) {
    for (int i = 0; i < 64; ++i)
        for (int j = 0; j < 64; ++j) {
            Point2 u(Float(i) / 64, Float(j) / 64), du(1.f / 256, 1.f / 256);
            EXPECT_LT(glm::length(SampleUniformDiskConcentric(u + du) - SampleUniformDiskConcentric(u)),
                      4 * glm::length(du));
        }
}

TEST(Warps, DirectionsFollowTheirDensities) {
    EXPECT_GT(SquareTest([](const Point2 &u) { return SphereCell(SampleUniformSphere(u)); }, Flat), 1e-4);
    // Densities per solid angle are multiplied by 4 Pi, the solid angle of the unit square of cell coordinates.
    auto upper = [](double z, double) { return z > 0.5 ? 4 * M_PI * double(UniformHemispherePdf()) : 0; };
    EXPECT_GT(SquareTest([](const Point2 &u) { return SphereCell(SampleUniformHemisphere(u)); }, upper), 1e-4);
    auto cosine = [](double z, double) {
        return z > 0.5 ? 4 * M_PI * double(CosineHemispherePdf(Float(2 * z - 1))) : 0;
    };
    EXPECT_GT(SquareTest([](const Point2 &u) { return SphereCell(SampleCosineHemisphere(u)); }, cosine), 1e-4);
    EXPECT_NEAR(UniformSpherePdf() * 4 * Pi, 1, 1e-6f);
    EXPECT_GT(SquareTest([](const Point2 &u) { return SphereCell(EqualAreaSquareToSphere(u)); }, Flat), 1e-4);
}

TEST(Warps, SampledDirectionsAreUnit) {
    Rng rng(3);
    for (int i = 0; i < 1000; ++i) {
        Point2 u = i == 0 ? Point2(0, 0) : i == 1 ? Point2(OneMinusEpsilon, OneMinusEpsilon) : rng.Uniform2();
        for (const Vector3 &w : {SampleUniformSphere(u), SampleUniformHemisphere(u), SampleCosineHemisphere(u),
                                 EqualAreaSquareToSphere(u)})
            EXPECT_NEAR(Length(w), 1, 2e-6f);
    }
}

TEST(Warps, TriangleIsUniformByArea) {
    // (1 - b0)^2 is uniformly distributed and, for any value of it, b1 / (1 - b0) is uniform too.
    auto cell = [](const Point2 &u) {
        Vector3 b = SampleUniformTriangle(u);
        EXPECT_GE(std::min({b.x, b.y, b.z}), 0);
        EXPECT_NEAR(b.x + b.y + b.z, 1, 1e-6f);
        return Point2(Sqr(1 - b.x), b.y / (1 - b.x));
    };
    EXPECT_GT(SquareTest(cell, Flat), 1e-4);
}

TEST(Warps, LinearSamplesFollowTheDensity) {
    for (auto [a, b] :
         {std::pair{1.f, 3.f}, {3.f, 1.f}, {0.f, 1.f}, {1.f, 0.f}, {2.f, 2.f}, {0.f, 0.f}, {1e-20f, 1e-20f}}) {
        Float lo = a, hi = b;
        auto sample = [&](const Point2 &u) { return Point2(SampleLinear(u.x, lo, hi), u.y); };
        auto density = [&](double x, double) {
            return lo + hi > 0 ? 2 * std::lerp(double(lo), double(hi), x) / double(lo + hi) : 1;
        };
        EXPECT_GT(SquareTest(sample, density), 1e-4) << a << " " << b;
        for (Float u : {0.f, 1e-6f, 0.25f, 0.5f, 0.9f, OneMinusEpsilon}) {
            Float x = SampleLinear(u, a, b);
            EXPECT_GE(x, 0);
            EXPECT_LT(x, 1);
        }
    }
}

TEST(Warps, BilinearSamplesFollowTheDensity) {
    const Float cases[][4] = {{1, 2, 3, 4}, {0, 0, 1, 1}, {1, 0, 0, 0}, {0, 1, 1, 0}, {5, 5, 5, 5}, {0, 0, 0, 0}};
    for (const auto &w : cases) {
        double p = SquareTest([&](const Point2 &u) { return SampleBilinear(u, w); },
                              [&](double x, double y) {
                                  return double(BilinearPdf({Float(x), Float(y)}, w));
                              });
        EXPECT_GT(p, 1e-4) << w[0] << w[1] << w[2] << w[3];
        Rng rng(5);
        for (int i = 0; i < 200; ++i) {
            // Exact zeros come from Sobol' points that are not randomized.
            Point2 u = i == 0 ? Point2(0, 0) : i == 1 ? Point2(0.3f, 0) : rng.Uniform2();
            Point2 s = SampleBilinear(u, w);
            ASSERT_TRUE(s.x >= 0 && s.x < 1 && s.y >= 0 && s.y < 1) << i;
        }
    }
}

TEST(Warps, HeuristicsShareOut) {
    for (auto [f, g] : {std::pair{1.f, 2.f}, {1e-10f, 3.f}, {5.f, 0.f}}) {
        EXPECT_NEAR(PowerHeuristic(f, g) + PowerHeuristic(g, f), 1, 1e-6f);
    }
    EXPECT_EQ(PowerHeuristic(1e30f, 1), 1);
    EXPECT_EQ(PowerHeuristic(1, 1e30f), 0);
    EXPECT_FLOAT_EQ(PowerHeuristic(1, 2), 0.2f);
}

TEST(EqualArea, LayoutIsThatOfPbrt) {
    auto expect = [](const Point2 &p, const Vector3 &w) {
        EXPECT_LT(Distance(EqualAreaSquareToSphere(p), w), 1e-6f) << p.x << " " << p.y;
        EXPECT_LT(glm::length(EqualAreaSphereToSquare(w) - p), 1e-6f) << p.x << " " << p.y;
    };
    expect({0.5f, 0.5f}, {0, 0, 1});
    expect({1, 0.5f}, {1, 0, 0});
    expect({0, 0.5f}, {-1, 0, 0});
    expect({0.5f, 1}, {0, 1, 0});
    expect({0.5f, 0}, {0, -1, 0});
    Float h = std::sqrt(0.5f);
    expect({0.75f, 0.75f}, {h, h, 0});
    for (const Point2 &corner : {Point2(0, 0), Point2(1, 0), Point2(0, 1), Point2(1, 1)})
        EXPECT_LT(Distance(EqualAreaSquareToSphere(corner), {0, 0, -1}), 1e-6f);
}

TEST(EqualArea, InverseUndoesBothWays) {
    Rng rng(6);
    for (int i = 0; i < 5000; ++i) {
        Point2 u = rng.Uniform2();
        EXPECT_LT(glm::length(EqualAreaSphereToSquare(EqualAreaSquareToSphere(u)) - u), 2e-4f) << u.x << " " << u.y;
        Vector3 w = SampleUniformSphere(u);
        EXPECT_LT(Distance(EqualAreaSquareToSphere(EqualAreaSphereToSquare(w)), w), 5e-4f);
    }
    for (const Vector3 &w :
         {Vector3(0, 0, 1), Vector3(0, 0, -1), Vector3(-0.f, 0, -1), Vector3(1, 0, 0), Vector3(0, -1, 0)}) {
        Point2 p = EqualAreaSphereToSquare(w);
        EXPECT_TRUE(p.x >= 0 && p.x <= 1 && p.y >= 0 && p.y <= 1);
        EXPECT_LT(Distance(EqualAreaSquareToSphere(p), w), 1e-3f);
    }
}

TEST(EqualArea, WrappedNeighboursAreNeighboursOnTheSphere) {
    Rng rng(7);
    constexpr Float kStep = 1e-3f;
    for (int i = 0; i < 2000; ++i) {
        Float t = rng.Uniform();
        Point2 edge[] = {{0, t}, {1, t}, {t, 0}, {t, 1}}, out[] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
        for (int side = 0; side < 4; ++side) {
            Point2 outside = WrapEqualAreaSquare(edge[side] + kStep * out[side]);
            EXPECT_TRUE(outside.x >= 0 && outside.x <= 1 && outside.y >= 0 && outside.y <= 1);
            Vector3 a = EqualAreaSquareToSphere(edge[side]), b = EqualAreaSquareToSphere(outside);
            EXPECT_LT(Distance(a, b), 8 * kStep);
            // A step out of the square and the same step into the square lead to different directions.
            Vector3 c = EqualAreaSquareToSphere(edge[side] - kStep * out[side]);
            if (std::abs(t - 0.5f) > 0.1f && t > 0.1f && t < 0.9f) {
                EXPECT_GT(Distance(b, c), kStep);
            }
        }
        Point2 inside = rng.Uniform2();
        EXPECT_EQ(WrapEqualAreaSquare(inside), inside);
    }
}

}  // namespace
}  // namespace pbrt
