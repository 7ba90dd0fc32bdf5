#include "pbrt/media/tracking.h"

#include <gtest/gtest.h>

#include "media_test_support.h"

namespace pbrt::test {
namespace {

/// Optical depths along the first `length` of a ray by the midpoint rule.
std::array<double, SpectrumSamples> OpticalDepth(const Medium &medium, const Ray &ray, Float length, int steps) {
    std::array<double, SpectrumSamples> depth{};
    for (int i = 0; i < steps; ++i) {
        const MediumCoefficients c = medium.At(ray((Float(i) + 0.5f) / Float(steps) * length), kLambda);
        for (int k = 0; k < SpectrumSamples; ++k)
            depth[size_t(k)] += double(c.absorption[k] + c.scattering[k]) * double(length) / steps;
    }
    return depth;
}

/// Unbiased estimate of the transmittance along a ray, per wavelength within [0, 1]: ratio tracking (Novak et al. 2014)
/// with the largest majorant of all wavelengths, hence valid for each of them.
SampledSpectrum RatioTransmittance(MediumOnRay &onRay, Rng &rng) {
    SampledSpectrum transmittance(1);
    Float depth = DepthThatTakes(rng.Uniform());
    MajorantSegment segment;
    while (onRay.Next(&segment)) {
        const Float majorant = segment.majorant.MaxComponent();
        for (Float begin = segment.begin;;) {
            const Float t = begin + depth / majorant;
            if (!(t < segment.end)) {
                depth = std::max(depth - majorant * (segment.end - begin), Float(0));
                break;
            }
            const MediumCoefficients c = onRay.At(t);
            transmittance *= ClampZero(SampledSpectrum(1) - (c.absorption + c.scattering) / majorant);
            if (!transmittance) return transmittance;
            begin = t;
            depth = DepthThatTakes(rng.Uniform());
        }
    }
    return transmittance;
}

/// Compares ratio tracking along a ray with exp(-depth).
void CheckTransmittance(const std::string &name, const Medium &medium, const Ray &ray, Float length, double worstP) {
    const auto depth = OpticalDepth(medium, ray, length, 4000);
    std::array<RunningStatistics, SpectrumSamples> mean;
    Rng rng(17);
    for (int i = 0; i < 4000; ++i) {
        MediumOnRay onRay = medium.On(ray, length, kLambda);
        const SampledSpectrum t = RatioTransmittance(onRay, rng);
        for (int k = 0; k < SpectrumSamples; ++k) {
            ASSERT_GE(t[k], 0);
            ASSERT_LE(t[k], 1);
            mean[size_t(k)].Add(double(t[k]));
        }
    }
    for (size_t k = 0; k < SpectrumSamples; ++k) {
        const double expected = std::exp(-depth[k]);
        // What quadrature cannot see of the kinks, and rounding where ratio tracking has no noise at all.
        if (std::abs(mean[k].mean - expected) < 1e-3 * expected + 1e-5) continue;
        // What is found rarely, or not at all, does not show its own variance, which is at most that of a coin.
        if (expected < 0.01) {
            EXPECT_LT(std::abs(mean[k].mean - expected), 6 * std::sqrt(expected / 4000) + 6.0 / 4000) << name;
            continue;
        }
        EXPECT_GT(NormalTail(mean[k].Z(expected)), worstP)
            << name << ' ' << k << ": " << mean[k].mean << " instead of " << expected;
    }
}

TEST(RatioTransmittance, AgreesWithQuadratureInAllMedia) {
    const int rays = 12;
    const double worst = SidakAlpha(1e-4, 4 * 5 * rays * SpectrumSamples);
    for (const Transform &place : Places())
        for (const NamedMedium &m : AllMedia(place)) {
            Rng rng(21);
            for (int i = 0; i < rays; ++i) {
                // From outside through the medium, from inside out, and inside only.
                const Point3 a = place.Point(PointNear(m.bounds, rng, i % 3 ? 0.f : 0.5f));
                const Point3 b = place.Point(PointNear(m.bounds, rng, i % 3 == 2 ? 0.f : 0.5f));
                CheckTransmittance(m.name, *m.medium, RayThrough(a, b), Distance(a, b), worst);
            }
        }
}

TEST(RatioTransmittance, NothingIsLostOnRaysThatMiss) {
    Rng rng(1);
    for (const NamedMedium &m : AllMedia({})) {
        if (m.name == "homogeneous") continue;
        for (const Point3 &to : {Point3(100, 0, 0), Point3(9, -50, 3)}) {
            MediumOnRay onRay = m.medium->On(RayThrough({5, 5, 5}, to), Infinity, kLambda);
            const SampledSpectrum t = RatioTransmittance(onRay, rng);
            EXPECT_EQ(t.MinComponent(), 1);
            MediumOnRay again = m.medium->On(RayThrough({5, 5, 5}, to), Infinity, kLambda);
            EXPECT_EQ(ForEachCollision(again, 0.99f, rng, [](auto &&...) { return true; }).MinComponent(), 1);
        }
    }
}

TEST(RatioTransmittance, AlongBordersOfCells) {
    const NamedMedium m = MakeSparseGrid({});
    const double worst = SidakAlpha(1e-4, 3 * 4 * SpectrumSamples);
    for (int a = 0; a < 3; ++a)
        for (Float at : {0.f, 0.25f, 0.5f, 1.f}) {
            Ray ray;
            ray.o = m.bounds.low + m.bounds.Diagonal() * at;
            ray.o[a] = m.bounds.low[a] - 1;
            ray.d = Vector3(0);
            ray.d[a] = 1;
            CheckTransmittance(m.name, *m.medium, ray, m.bounds.Diagonal()[a] + 2, worst);
        }
}

TEST(ForEachCollision, ProductOfTransmittancesIsThatOfTheMajorants) {
    for (const NamedMedium &m : AllMedia(Places()[1])) {
        Rng rng(2);
        for (int i = 0; i < 200; ++i) {
            const Point3 a = m.place.Point(PointNear(m.bounds, rng, 0.5f)), b = m.place.Point(PointNear(m.bounds, rng));
            MediumOnRay walk = m.medium->On(RayThrough(a, b), 3, kLambda), onRay = walk;
            SampledSpectrum expected(1), product(1);
            MajorantSegment s;
            while (walk.Next(&s)) expected *= MajorantTransmittance(s.majorant, s.end - s.begin);
            Float last = 0;
            product *= ForEachCollision(onRay, rng.Uniform(), rng,
                                        [&](Float t, const MediumCoefficients &c, const SampledSpectrum &majorant,
                                            const SampledSpectrum &tMaj) {
                                            EXPECT_GE(t, last);
                                            EXPECT_LE(t, 3);
                                            EXPECT_LE(c.absorption[0] + c.scattering[0], majorant[0]);
                                            last = t;
                                            product *= tMaj;
                                            return true;
                                        });
            for (int k = 0; k < SpectrumSamples; ++k) EXPECT_NEAR(product[k], expected[k], 1e-4f) << m.name;
        }
    }
}

TEST(ForEachCollision, CollisionsFollowTheMajorantOfTheFirstWavelength) {
    const NamedMedium m = MakeSparseGrid(Places()[3]);
    const Ray ray = RayThrough(m.place.Point({-1.2f, -0.7f, -1.1f}), m.place.Point({0.9f, 0.4f, 1.9f}));
    // The segments are the cells of the histogram.
    std::vector<MajorantSegment> segments;
    MediumOnRay walk = m.medium->On(ray, 10, kLambda);
    for (MajorantSegment s; walk.Next(&s);) segments.push_back(s);
    ASSERT_GT(segments.size(), 8u);
    Rng rng(31);
    std::vector<double> found(segments.size()), expected(segments.size());
    const int n = 20000;
    for (int i = 0; i < n; ++i) {
        MediumOnRay onRay = m.medium->On(ray, 10, kLambda);
        ForEachCollision(onRay, rng.Uniform(), rng, [&](Float t, auto &&...) {
            for (size_t k = 0; k < segments.size(); ++k)
                if (t >= segments[k].begin && t < segments[k].end) ++found[k];
            return true;
        });
    }
    double chi2 = 0;  // counts of a Poisson process are independent
    for (size_t k = 0; k < segments.size(); ++k) {
        expected[k] = n * double(segments[k].majorant[0]) * double(segments[k].end - segments[k].begin);
        chi2 += (found[k] - expected[k]) * (found[k] - expected[k]) / expected[k];
    }
    EXPECT_GT(ChiSquareTail(chi2, int(segments.size())), 1e-4);
}

TEST(ForEachCollision, TheNumberGivenDecidesTheFirstCollision) {
    const auto medium = MakeMedium("homogeneous", Params().Rgb("sigma_a", 1, 1, 1).Rgb("sigma_s", 1, 1, 1));
    const MediumCoefficients c = medium->At({0, 0, 0}, kLambda);
    Rng rng(3);
    for (Float u : {0.f, 0.1f, 0.5f, 0.99f, OneMinusEpsilon}) {
        MediumOnRay onRay = medium->On(Ray(), Infinity, kLambda);
        Float first = -1;
        SampledSpectrum transmittance;
        const SampledSpectrum rest = ForEachCollision(
            onRay, u, rng,
            [&](Float t, const MediumCoefficients &, const SampledSpectrum &, const SampledSpectrum &tr) {
                first = t;
                transmittance = tr;
                return false;
            });
        EXPECT_EQ(rest.MinComponent(), 1);
        EXPECT_NEAR(first, -std::log1p(-u) / (c.absorption[0] + c.scattering[0]), 1e-4f * (1 + first));
        EXPECT_NEAR(transmittance[0], 1 - u, 1e-5f);
    }
}

TEST(ForEachCollision, NoCollisionsWhereTheFirstWavelengthMeetsNothing) {
    // A spectrum that is 0 at the first wavelength only.
    std::vector<Float> samples = {kLambda[0] - 2, 1, kLambda[0] - 1, 0, kLambda[0] + 1, 0, kLambda[0] + 2, 1};
    samples.insert(samples.begin(), {300, 1});
    samples.insert(samples.end(), {900, 1});
    Params p;
    p.Floats(ParamType::Spectrum, "sigma_a", samples).Rgb("sigma_s", 0, 0, 0);
    const auto medium = MakeMedium("homogeneous", p);
    Rng rng(1);
    for (Float tMax : {2.f, Infinity}) {
        MediumOnRay onRay = medium->On(Ray(), tMax, kLambda);
        const SampledSpectrum t = ForEachCollision(onRay, 0.9f, rng, [](auto &&...) {
            ADD_FAILURE();
            return true;
        });
        EXPECT_EQ(t[0], 1);
        for (int k = 1; k < SpectrumSamples; ++k) EXPECT_NEAR(t[k], std::exp(-tMax), 1e-5f);
    }
}

}  // namespace
}  // namespace pbrt::test
