#include "pbrt/bxdfs/henyey_greenstein.h"

#include <gtest/gtest.h>

#include "sphere_histogram.h"

namespace pbrt::test {
namespace {

TEST(HenyeyGreenstein, SamplesFollowTheDensityThatIntegratesToOne) {
    const Vector3 wo = DirectionAt(70, 200);
    for (Float g : {-0.6f, 0.f, 5e-4f, 0.3f, 0.7f}) {
        const HenyeyGreenstein phase(g);
        double mass;
        double p =
            DirectionTest([&](Rng &rng) -> std::optional<Vector3> { return phase.SampleP(wo, rng.Uniform2()).wi; },
                          [&](const Vector3 &wi) { return phase.P(wo, wi); }, 50000, 4, &mass);
        EXPECT_GT(p, SidakAlpha(1e-4, 5)) << g;
        EXPECT_NEAR(mass, 1, 1e-3) << g;
    }
}

TEST(HenyeyGreenstein, MeanCosineOfDeflectionIsG) {
    const Vector3 wo = DirectionAt(20, 10);
    for (Float g : {-0.99f, -0.6f, 0.f, 1e-5f, 0.8f}) {
        RunningStatistics cosine;
        Rng rng(7);
        const HenyeyGreenstein phase(g);
        EXPECT_EQ(phase.G(), g);
        for (int i = 0; i < 20000; ++i) {
            const HenyeyGreenstein::Sample sample = phase.SampleP(wo, rng.Uniform2());
            EXPECT_NEAR(Length(sample.wi), 1, 1e-5f);
            const Float p = phase.P(wo, sample.wi);
            EXPECT_NEAR(sample.p, p, 1e-2f * p);  // rounded in another order, which matters at the peaks
            cosine.Add(double(Dot(-wo, sample.wi)));
        }
        EXPECT_LT(std::abs(cosine.Z(double(g))), 4) << g;
    }
}

TEST(HenyeyGreenstein, ScattersForwardWhereGIsAboveZero) {
    const Vector3 wo(0, 0, 1);
    EXPECT_GT(HenyeyGreenstein(0.5f).P(wo, -wo), 5 * HenyeyGreenstein(0.5f).P(wo, wo));
    EXPECT_GT(HenyeyGreenstein(-0.5f).P(wo, wo), 5 * HenyeyGreenstein(-0.5f).P(wo, -wo));
    EXPECT_NEAR(HenyeyGreenstein().P(wo, Vector3(1, 0, 0)), Inv4Pi, 1e-7f);
    // The formula at a right angle: (1 - g^2) / (4 pi (1 + g^2)^(3/2)).
    EXPECT_NEAR(HenyeyGreenstein(0.5f).P(wo, Vector3(1, 0, 0)), Inv4Pi * 0.75f / std::pow(1.25f, 1.5f), 1e-6f);
}

TEST(HenyeyGreenstein, ExtremeParametersStayFinite) {
    for (Float g : {-1.f, 1.f}) {
        const HenyeyGreenstein phase(g);
        const Vector3 wo(0, 0, 1);
        for (Float u : {0.f, 0.5f, OneMinusEpsilon}) {
            const HenyeyGreenstein::Sample sample = phase.SampleP(wo, {u, 0.25f});
            EXPECT_TRUE(std::isfinite(sample.p) && sample.p > 0) << g << ' ' << u;
        }
    }
}

}  // namespace
}  // namespace pbrt::test
