#include "pbrt/bxdfs/boundaries.h"

#include <gtest/gtest.h>

#include "sphere_histogram.h"

namespace pbrt::test {
namespace {

TEST(TrowbridgeReitz, ProjectedAreaOfTheFacetsIsOne) {
    for (auto [ax, ay] : {std::pair{0.1f, 0.1f}, {0.5f, 0.5f}, {0.15f, 0.8f}, {1.f, 0.3f}}) {
        TrowbridgeReitz facets(ax, ay);
        auto projected = [&](const Vector3 &m) { return m.z > 0 ? facets.D(m) * m.z : 0; };
        EXPECT_NEAR(SphereIntegral(projected, 40), 1, 3e-3) << ax << ' ' << ay;
    }
}

// Heitz 2014, eq. 21: the projected area of the visible facets is that of the surface.
TEST(TrowbridgeReitz, VisibleFacetsHaveTheProjectedAreaOfTheSurface) {
    for (auto [ax, ay] : {std::pair{0.3f, 0.3f}, {0.15f, 0.8f}})
        for (Float theta : {0.f, 30.f, 60.f, 85.f}) {
            TrowbridgeReitz facets(ax, ay);
            Vector3 w = DirectionAt(theta, 25);
            auto visible = [&](const Vector3 &m) {
                return m.z > 0 ? facets.G1(w) * std::max(Float(0), Dot(w, m)) * facets.D(m) : 0;
            };
            EXPECT_NEAR(SphereIntegral(visible, 40) / double(w.z), 1, 5e-3) << ax << ' ' << ay << ' ' << theta;
        }
}

TEST(TrowbridgeReitz, JointShadowingLiesBetweenProductAndSmaller) {
    TrowbridgeReitz facets(0.4f, 0.7f);
    for (Float a = 5; a < 90; a += 10)
        for (Float b = 5; b < 90; b += 10) {
            Vector3 wo = DirectionAt(a, 10), wi = DirectionAt(b, 200);
            Float g = facets.G(wo, wi);
            EXPECT_GE(g, facets.G1(wo) * facets.G1(wi) * 0.9999f);
            EXPECT_LE(g, std::min(facets.G1(wo), facets.G1(wi)) * 1.0001f);
            EXPECT_FLOAT_EQ(g, facets.G(wi, wo));
        }
}

TEST(TrowbridgeReitz, VisibleNormalsFollowTheirDensity) {
    size_t cases = 2 * 2 * 4;
    for (auto sample : {&TrowbridgeReitz::SampleVisible, &TrowbridgeReitz::SampleVisibleByCap})
        for (auto [ax, ay] : {std::pair{0.3f, 0.3f}, {0.15f, 0.8f}})
            for (Float theta : {0.f, 40.f, 75.f, 140.f}) {
                TrowbridgeReitz facets(ax, ay);
                Vector3 w = DirectionAt(theta, 65);
                double mass;
                double p = DirectionTest(
                    [&](Rng &rng) -> std::optional<Vector3> { return (facets.*sample)(w, rng.Uniform2()); },
                    [&](const Vector3 &m) { return m.z > 0 && Dot(w, m) * w.z > 0 ? facets.VisiblePdf(w, m) : 0; },
                    50000, 12, &mass);
                EXPECT_GT(p, SidakAlpha(1e-4, cases)) << ax << ' ' << ay << ' ' << theta;
                EXPECT_NEAR(mass, 1, 5e-3);
            }
}

TEST(TrowbridgeReitz, GOverG1IsTheirQuotient) {
    TrowbridgeReitz facets(0.4f, 0.2f);
    for (Float a = 5; a < 90; a += 20) {
        const Vector3 wo = DirectionAt(a, 10), wi = DirectionAt(80 - a / 2, 200);
        EXPECT_FLOAT_EQ(facets.GOverG1(wo, wi), facets.G(wo, wi) / facets.G1(wo));
    }
}

TEST(TrowbridgeReitz, SmoothnessAndRegularisation) {
    EXPECT_TRUE(TrowbridgeReitz(0.0009f, 0.0009f).EffectivelySmooth());
    EXPECT_FALSE(TrowbridgeReitz(0.0009f, 0.0011f).EffectivelySmooth());
    EXPECT_FLOAT_EQ(TrowbridgeReitz(0, 0.2f).AlphaX(), 1e-4f);
    EXPECT_FLOAT_EQ(TrowbridgeReitz::RoughnessToAlpha(0.09f), 0.3f);
    EXPECT_EQ(TrowbridgeReitz::RoughnessToAlpha(-0.09f), 0);  // of textures such as fbm
    TrowbridgeReitz facets(0, 0.12f);
    facets.Regularize();
    EXPECT_FLOAT_EQ(facets.AlphaX(), 0.1f);
    EXPECT_FLOAT_EQ(facets.AlphaY(), 0.24f);
    facets = {0.29f, 0.5f};
    facets.Regularize();
    EXPECT_FLOAT_EQ(facets.AlphaX(), 0.3f);
    EXPECT_FLOAT_EQ(facets.AlphaY(), 0.5f);
}

}  // namespace
}  // namespace pbrt::test
