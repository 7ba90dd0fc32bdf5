#include "pbrt/bxdfs/henyey_greenstein.h"

#include <gtest/gtest.h>

#include "sphere_histogram.h"

namespace pbrt {
namespace {

TEST(HenyeyGreenstein, SamplesFollowTheDensityThatIntegratesToOne) {
    Vector3 in = test::DirectionAt(70, 200);
    for (Float g : {-0.6f, 0.f, 5e-4f, 0.3f, 0.7f}) {
        HenyeyGreenstein phase(g);
        double mass;
        double p =
            test::DirectionTest([&](Rng &rng) -> std::optional<Vector3> { return phase.Sample(in, rng.Uniform2()); },
                                [&](const Vector3 &w) { return phase.Pdf(in, w); }, 50000, 4, &mass);
        EXPECT_GT(p, test::SidakAlpha(1e-4, 5)) << g;
        EXPECT_NEAR(mass, 1, 1e-3) << g;
    }
}

TEST(HenyeyGreenstein, MeanCosineIsG) {
    Vector3 in = test::DirectionAt(20, 10);
    for (Float g : {-0.6f, 0.f, 0.8f}) {
        test::RunningStatistics cosine;
        Rng rng(7);
        for (int i = 0; i < 20000; ++i) cosine.Add(double(Dot(in, HenyeyGreenstein(g).Sample(in, rng.Uniform2()))));
        EXPECT_LT(std::abs(cosine.Z(double(g))), 4) << g;
    }
}

}  // namespace
}  // namespace pbrt
