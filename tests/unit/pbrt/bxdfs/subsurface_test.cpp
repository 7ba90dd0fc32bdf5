#include <gtest/gtest.h>

#include <map>

#include "pbrt/bxdfs/bssrdf.h"
#include "pbrt/bxdfs/fresnel.h"
#include "pbrt/bxdfs/henyey_greenstein.h"
#include "sphere_histogram.h"

namespace pbrt::test {
namespace {

TEST(FresnelMoments, ObeyReciprocity) {
    // The mean transmittance from inside is that from outside divided by eta^2, the ratio of solid angles (Duderstadt;
    // Egan and Hilgeman).
    for (Float eta : {1.1f, 1.33f, 1.5f, 2.f}) {
        const Float inside = 1 - 2 * InnerFresnelMoment(eta, 1), outside = 1 - 2 * InnerFresnelMoment(1 / eta, 1);
        EXPECT_NEAR(inside, outside / Sqr(eta), 2e-4f) << eta;
    }
    EXPECT_NEAR(InnerFresnelMoment(1, 1), 0, 1e-5f);
    // Beyond the critical angle everything is reflected, and before it only little.
    const Float critical = std::sqrt(1 - 1 / Sqr(1.33f));
    EXPECT_GT(InnerFresnelMoment(1.33f, 0), critical);
    EXPECT_LT(InnerFresnelMoment(1.33f, 0), critical + .05f);
}

class Table : public testing::TestWithParam<std::pair<Float, Float>> {
  protected:
    static const SubsurfaceTable &Made(std::pair<Float, Float> matter) {
        static std::map<std::pair<Float, Float>, SubsurfaceTable> tables;
        const auto it = tables.find(matter);
        if (it != tables.end()) return it->second;
        return tables.emplace(matter, SubsurfaceTable::Compute(matter.first, matter.second)).first->second;
    }
    const SubsurfaceTable &table_ = Made(GetParam());
};
INSTANTIATE_TEST_SUITE_P(Matter, Table,
                         testing::Values(std::pair(0.f, 1.33f), std::pair(.6f, 1.33f), std::pair(-.4f, 1.5f),
                                         std::pair(0.f, 1.05f)));

TEST_P(Table, MoreAlbedoReflectsMoreAndHardlyEverMoreThanAll) {
    Float last = 0;
    EXPECT_EQ(table_.AtAlbedo(0).reflectance, 0);
    for (Float albedo = .01f; albedo <= 1; albedo += .01f) {
        const Float reflectance = table_.AtAlbedo(albedo).reflectance;
        EXPECT_GT(reflectance, last) << albedo;
        last = reflectance;
    }
    // Diffusion is not exact: where almost nothing is absorbed, the reflected light is a little more than came in (the
    // tables of stock pbrt-v4 are the same).
    EXPECT_LE(table_.AtAlbedo(1).reflectance, GetParam().second == 1.33f ? 1.02f : 1.11f);
    EXPECT_LE(table_.AtAlbedo(.995f).reflectance, 1);
}

TEST_P(Table, AlbedoAndReflectanceRoundTrip) {
    for (Float albedo = .02f; albedo < 1; albedo += .049f)
        EXPECT_NEAR(table_.AlbedoOf(table_.AtAlbedo(albedo).reflectance), albedo, 2e-3f);
    EXPECT_GT(table_.AlbedoOf(1), .999f);
    EXPECT_EQ(table_.AlbedoOf(2), 1);
    EXPECT_EQ(table_.AlbedoOf(0), 0);
}

TEST_P(Table, ProfileFallsWithRadiusAndGrowsWithAlbedo) {
    for (Float albedo : {.2f, .8f, .98f, 1.f}) {
        const SubsurfaceTable::Row row = table_.AtAlbedo(albedo), less = table_.AtAlbedo(albedo * .9f);
        Float last = Infinity;
        for (Float r = 0.01f; r < 10; r *= 1.1f) {
            const Float value = table_.Profile(row, r);
            EXPECT_GT(value, 0) << r;
            EXPECT_LT(value, last * 1.001f) << r;
            EXPECT_GT(value, table_.Profile(less, r)) << r;
            last = value;
        }
    }
    EXPECT_EQ(table_.Profile(table_.AtAlbedo(.9f), 1e4f), 0);
}

TEST_P(Table, ProfileIntegratesToReflectance) {
    for (Float albedo : {.3f, .9f, .995f}) {
        const SubsurfaceTable::Row row = table_.AtAlbedo(albedo);
        double sum = 0;
        constexpr int n = 20000;
        for (int i = 0; i < n; ++i) {  // r = 200 t^4
            const double t = (i + .5) / n, r = 200 * t * t * t * t;
            sum += 2 * M_PI * r * double(table_.Profile(row, Float(r))) * 800 * t * t * t / n;
        }
        EXPECT_NEAR(sum, double(row.reflectance), 2e-3 * sum) << albedo;
    }
}

TEST_P(Table, RadiiFollowTheProfile) {
    for (Float albedo : {.35f, .93f}) {
        const SubsurfaceTable::Row row = table_.AtAlbedo(albedo);
        constexpr int cells = 40, n = 40000;
        // The cells are equal in log(1 + 20 r), up to r = 20.
        auto edge = [](double i) { return (std::exp(std::log(401.) * i / cells) - 1) / 20; };
        std::vector<double> observed(cells + 1), expected(cells + 1);
        Rng rng(3);
        for (int i = 0; i < n; ++i) {
            const double r = double(table_.SampleRadius(row, rng.Uniform()));
            const double cell = cells * std::log(1 + 20 * r) / std::log(401.);
            ++observed[std::min<size_t>(cells, size_t(cell))];
        }
        double rest = n;
        for (int i = 0; i < cells; ++i) {
            double sum = 0;
            constexpr int m = 100;
            for (int k = 0; k < m; ++k) {
                const double r = edge(i) + (edge(i + 1) - edge(i)) * (k + .5) / m;
                sum += 2 * M_PI * r * double(table_.Profile(row, Float(r))) / m;
            }
            expected[size_t(i)] = n * sum * (edge(i + 1) - edge(i)) / double(row.reflectance);
            rest -= expected[size_t(i)];
        }
        expected[cells] = std::max(rest, 0.);
        EXPECT_GT(ChiSquareTest(observed, expected), SidakAlpha(1e-4, 8)) << albedo;
    }
}

/// The reference: the share of a thin beam of light that random walks bring back through the surface.
double WalkedReflectance(Float albedo, Float g, Float eta, int photons) {
    Rng rng(11);
    const HenyeyGreenstein phase(g);
    double sum = 0;
    for (int i = 0; i < photons; ++i) {
        Vector3 d(0, 0, -1);
        Float z = 0, weight = 1;
        while (weight > 0) {
            z += d.z * -std::log(1 - rng.Uniform());
            while (z > 0) {
                if (rng.Uniform() >= FresnelDielectric(-std::abs(d.z), eta)) {
                    sum += double(weight);
                    weight = 0;
                    break;
                }
                z = -z;
                d.z = -d.z;
            }
            weight *= albedo;
            if (weight < .1f) weight = rng.Uniform() < .5f ? 2 * weight : 0;
            d = Normalize(phase.SampleP(-d, rng.Uniform2()).wi);
        }
    }
    return sum / photons;
}

TEST(SubsurfaceTable, IsNearARandomWalk) {
    for (Float g : {0.f, .5f}) {
        const SubsurfaceTable table = SubsurfaceTable::Compute(g, 1.33f);
        for (Float albedo : {.6f, .9f, .99f}) {
            const double walked = WalkedReflectance(albedo, g, 1.33f, 20000);
            EXPECT_NEAR(double(table.AtAlbedo(albedo).reflectance) / walked, 1, .12) << albedo << " g " << g;
        }
    }
}

TEST(SubsurfaceTable, IsShared) {
    const std::shared_ptr<const SubsurfaceTable> a = SubsurfaceTable::Shared(.1f, 1.2f);
    EXPECT_EQ(a, SubsurfaceTable::Shared(.1f, 1.2f));
    EXPECT_NE(a, SubsurfaceTable::Shared(.1f, 1.3f));
}

/// A ball of radius 1 about the origin; light enters at p, where the shading normal differs from the geometric one.
class BssrdfOnBall : public testing::Test {
  protected:
    Bssrdf Make(const SampledWavelengths &lambda) const {
        const SampledSpectrum albedo = Values(.95f, .8f, .6f, .99f), sigmaT = Values(2, 4, 9, 3);
        return Bssrdf(p_, ns_, (SampledSpectrum(1) - albedo) * sigmaT, albedo * sigmaT, lambda, table_);
    }
    /// The points inside of the segment of the probe where it crosses the ball.
    static std::vector<Point3> Crossings(const Bssrdf::Probe &probe) {
        const Vector3 d = probe.to - probe.from;
        const double a = double(Dot(d, d)), b = double(Dot(d, probe.from)), c = double(Dot(probe.from, probe.from)) - 1;
        const double root = b * b - a * c;
        std::vector<Point3> points;
        if (root < 0) return points;
        for (double t : {(-b - std::sqrt(root)) / a, (-b + std::sqrt(root)) / a})
            if (t > 0 && t < 1) points.push_back(Normalize(probe.from + d * Float(t)));
        return points;
    }

    const SubsurfaceTable table_ = SubsurfaceTable::Compute(0, 1.33f);
    const Normal3 n_ = DirectionAt(40, 70);
    const Point3 p_ = n_;
    const Normal3 ns_ = Normalize(n_ + Vector3(.1f, .2f, -.1f));
};

TEST_F(BssrdfOnBall, CrossingsHaveThePdf) {
    for (bool dispersed : {false, true}) {
        SampledWavelengths lambda = SampledWavelengths::SampleVisible(.3f);
        if (dispersed) lambda.TerminateSecondary();
        const Bssrdf bssrdf = Make(lambda);
        SphereHistogram histogram(12, 12);
        constexpr int n = 100000;
        Rng rng(5);
        for (int i = 0; i < n; ++i) {
            const Float uc = rng.Uniform();
            if (auto probe = bssrdf.SampleProbe(uc, rng.Uniform2()))
                for (const Point3 &x : Crossings(*probe)) histogram.Add(x);
        }
        const std::vector<double> expected =
            histogram.Integrate([&](const Vector3 &x) { return bssrdf.Pdf(x, x); }, 30);
        double worst = 0;
        for (size_t i = 0; i < expected.size(); ++i) {
            const double mean = n * expected[i];
            if (mean < 10) continue;
            // The z value of the count of a cell. The two crossings of one probe fall into different cells, except near
            // the rim.
            const double z = (histogram.Counts()[i] - mean) / std::sqrt(mean + Sqr(.01 * mean));
            worst = std::max(worst, std::abs(z));
        }
        EXPECT_GT(NormalTail(worst), SidakAlpha(1e-4, expected.size())) << "worst z " << worst;
    }
}

TEST_F(BssrdfOnBall, DrawnExitsGiveTheIntegralOfTheProfile) {
    const Bssrdf bssrdf = Make(SampledWavelengths::SampleVisible(.3f));
    std::array<RunningStatistics, SpectrumSamples> estimate;
    Rng rng(9);
    for (int i = 0; i < 200000; ++i) {
        SampledSpectrum weight(0);
        const Float uc = rng.Uniform();
        if (auto probe = bssrdf.SampleProbe(uc, rng.Uniform2())) {
            const std::vector<Point3> crossings = Crossings(*probe);
            if (!crossings.empty()) {
                const auto count = uint32_t(crossings.size());
                const Point3 x = crossings[rng.UniformInt(count)];
                const Float pdf = bssrdf.Pdf(x, x) / Float(count);
                if (pdf > 0) weight = bssrdf.Profile(Distance(p_, x)) / pdf;
            }
        }
        for (int k = 0; k < SpectrumSamples; ++k) estimate[size_t(k)].Add(double(weight[k]));
    }
    const SphereHistogram sphere(50, 50);
    for (int k = 0; k < SpectrumSamples; ++k) {
        double expected = 0;
        for (double cell : sphere.Integrate([&](const Vector3 &x) { return bssrdf.Profile(Distance(p_, x))[k]; }, 16))
            expected += cell;
        const RunningStatistics &s = estimate[size_t(k)];
        // The last thousandth of each profile is cut off; the quadrature errs by as much at the peak at p.
        EXPECT_LT(std::abs(s.mean - expected), 4 * s.StandardError() + .004 * expected)
            << k << ": " << s.mean << " for " << expected;
    }
}

TEST(Bssrdf, NothingComesOutOfMatterThatOnlyAbsorbs) {
    const SubsurfaceTable table = SubsurfaceTable::Compute(0, 1.33f);
    const Bssrdf black(Point3(0), Normal3(0, 0, 1), SampledSpectrum(2), SampledSpectrum(0),
                       SampledWavelengths::SampleVisible(.5f), table);
    EXPECT_FALSE(black.SampleProbe(.6f, {.3f, .4f}));
    const Bssrdf empty(Point3(0), Normal3(0, 0, 1), SampledSpectrum(0), SampledSpectrum(0),
                       SampledWavelengths::SampleVisible(.5f), table);
    EXPECT_FALSE(empty.SampleProbe(.6f, {.3f, .4f}));
    EXPECT_EQ(empty.Pdf(Point3(1, 0, 0), Normal3(0, 0, 1)), 0);
}

TEST(ExitLobe, SendsOutWhatComesInAndFollowsItsDensity) {
    for (Float eta : {1.1f, 1.33f, 2.f}) {
        const NormalizedFresnelBxdf lobe(eta, 1 / (Pi * (1 - 2 * InnerFresnelMoment(1 / eta, 1))));
        const Vector3 up(0, 0, 1);
        auto albedo = [&](TransportMode mode) {
            return SphereIntegral([&](const Vector3 &wi) { return lobe.F(up, wi, mode)[0] * AbsCosTheta(wi); }, 10);
        };
        EXPECT_NEAR(albedo(TransportMode::Importance), 1, 2e-3) << eta;
        EXPECT_NEAR(albedo(kRadiance), double(Sqr(eta)), 2e-3 * double(Sqr(eta))) << eta;
        for (const Vector3 &wo : {up, -up, DirectionAt(70, 30)}) {
            const double p =
                DirectionTest([&](Rng &rng) { return DirectionOf(SampleLobe(lobe, wo, rng, kRadiance)); },
                              [&](const Vector3 &wi) { return lobe.Pdf(wo, wi, kRadiance); }, 20000, 16, nullptr);
            EXPECT_GT(p, 1e-5);
        }
    }
}

}  // namespace
}  // namespace pbrt::test
