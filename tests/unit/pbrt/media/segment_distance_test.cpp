#include "pbrt/media/segment_distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "pbrt/math/rng.h"
#include "support/statistics.h"

namespace pbrt::test {
namespace {

/// Draws distances, counts them in bins and compares the counts with integrals of the density over the bins.
template <class Distances>
void CheckPair(const char *name, const Distances &distances, Float tMax) {
    constexpr int kBins = 40, kDraws = 40000, kSteps = 4000;
    // Bins in x = t / (1 + t), so that infinite distances have a last bin.
    auto toX = [](double t) { return std::isinf(t) ? 1 : t / (1 + t); };
    const double last = toX(double(tMax));
    std::vector<double> expected(kBins, 0), counts(kBins, 0);
    double whole = 0;
    for (int i = 0; i < kBins * kSteps; ++i) {
        const double x = (i + .5) / (kBins * kSteps) * last, t = x / (1 - x);
        const double mass = double(distances.Pdf(Float(t))) / ((1 - x) * (1 - x)) * last / (kBins * kSteps);
        expected[size_t(i / kSteps)] += mass;
        whole += mass;
    }
    EXPECT_NEAR(whole, 1, 2e-3) << name;
    Rng rng(3);
    for (int i = 0; i < kDraws; ++i) {
        const double t = double(distances.Sample(rng.Uniform()));
        ASSERT_GE(t, 0) << name;
        ASSERT_LE(t, double(tMax)) << name;
        ++counts[std::min(size_t(toX(t) / last * kBins), size_t(kBins - 1))];
    }
    double chi2 = 0;
    int bins = -1;
    for (size_t i = 0; i < kBins; ++i) {
        const double e = expected[i] / whole * kDraws;
        if (e < 5) {
            EXPECT_LT(counts[i], 30) << name;
            continue;
        }
        chi2 += (counts[i] - e) * (counts[i] - e) / e;
        ++bins;
    }
    if (bins > 0) {
        EXPECT_GT(ChiSquareTail(chi2, bins), 1e-5) << name;
    }
}

Ray Along(const Point3 &from, const Vector3 &d) {
    Ray ray;
    ray.o = from;
    ray.d = Normalize(d);
    return ray;
}

TEST(EquiangularDistance, DrawsByItsDensity) {
    const Ray ray = Along({1, 2, 3}, {1, 1, .3f});
    CheckPair("beside", EquiangularDistance(ray, 5, {3, 3, 3}, 0), 5);
    CheckPair("behind the origin", EquiangularDistance(ray, 5, {-1, 0, 3}, 0), 5);
    CheckPair("beyond the end", EquiangularDistance(ray, 2, {9, 9, 5}, 0), 2);
    CheckPair("far away", EquiangularDistance(ray, 2, {9e5f, -4e5f, 5}, 0), 2);
    CheckPair("near a large light", EquiangularDistance(ray, 5, {3, 3, 3}, 2), 5);
    CheckPair("no end", EquiangularDistance(ray, Infinity, {3, 3, 3}, .5f), Infinity);
    CheckPair("no end, light behind", EquiangularDistance(ray, Infinity, {0, 0, 3}, .5f), Infinity);
}

TEST(EquiangularDistance, ALightOnTheRayHasAFiniteDensity) {
    const Ray ray = Along({0, 0, 0}, {0, 0, 1});
    const EquiangularDistance distances(ray, 10, {0, 0, 4}, 0);
    ASSERT_TRUE(distances.IsValid());
    for (Float u : {0.f, .25f, .5f, .75f, OneMinusEpsilon}) {
        const Float t = distances.Sample(u);
        EXPECT_TRUE(t >= 0 && t <= 10) << u;
        EXPECT_TRUE(std::isfinite(distances.Pdf(t)) && distances.Pdf(t) > 0) << u;
    }
    EXPECT_TRUE(std::isfinite(EquiangularDistance(ray, 10, {0, 0, 0}, 0).Sample(.5f)));
}

TEST(TransmittanceDistance, DrawsByItsDensity) {
    CheckPair("thin", TransmittanceDistance(1e-4f, 3), 3);
    CheckPair("thick", TransmittanceDistance(2, 3), 3);
    CheckPair("no end", TransmittanceDistance(.5f, Infinity), Infinity);
    EXPECT_FALSE(TransmittanceDistance(0, 3).IsValid());
}

}  // namespace
}  // namespace pbrt::test
