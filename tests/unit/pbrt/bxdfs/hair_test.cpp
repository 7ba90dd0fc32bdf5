#include "pbrt/bxdfs/hair.h"

#include <gtest/gtest.h>

#include "pbrt/bxdfs/bsdf.h"
#include "pbrt/bxdfs/fresnel.h"
#include "sphere_histogram.h"

namespace pbrt::test {
namespace {

const std::vector<Vector3> &HairViews() {
    static const std::vector<Vector3> views = {DirectionAt(0, 0), DirectionAt(40, 25), DirectionAt(80, 10),
                                               DirectionAt(120, 100), DirectionAt(70, 178)};
    return views;
}

template <class Check>
void ForEachHair(std::initializer_list<Float> roughnesses, Check check) {
    for (Float betaM : roughnesses)
        for (Float betaN : roughnesses)
            for (Float offset : {-0.95f, 0.f, 0.4f}) check(betaM, betaN, offset);
}

/// A Bsdf holds a frame, the largest lobe and its index, without padding: the rare hair lobe must not make all others
/// larger.
TEST(Hair, TheBsdfDoesNotGrowByIt) {
    EXPECT_LE(sizeof(HairBxdf), sizeof(CoatedConductorBxdf));
    // The index of the lobe and its flags take one Float each.
    EXPECT_EQ(sizeof(Bsdf), sizeof(Frame) + sizeof(CoatedConductorBxdf) + 2 * sizeof(Float));
}

TEST(Hair, LongitudinalDensityIntegratesToOne) {
    for (Float variance : {2e-5f, 1e-3f, 0.02f, 0.0999f, 0.1001f, 0.5f, 3.f, 100.f})
        for (Float thetaO : {-80.f, -30.f, 0.f, 45.f, 89.f}) {
            double sum = 0;
            constexpr int kSteps = 40000;
            for (int i = 0; i < kSteps; ++i) {
                double theta = M_PI * ((i + 0.5) / kSteps - 0.5), c = std::cos(theta);
                sum += double(LongitudinalDensity(Float(std::sin(theta)), Float(c), std::sin(Radians(thetaO)),
                                                  std::cos(Radians(thetaO)), variance)) *
                       c * M_PI / kSteps;
            }
            // The tolerance is the rounding of sines and cosines divided by the variance.
            EXPECT_NEAR(sum, 1, 2e-4 + 2e-7 / double(variance)) << variance << " " << thetaO;
        }
}

/// The reference is the formula of the paper in double precision, where it does not overflow.
TEST(Hair, LongitudinalDensityIsThatOfThePaper) {
    auto besselI0 = [](double x) {
        double sum = 1, term = 1;
        for (int k = 1; k < 200; ++k) sum += term *= x * x / (4.0 * k * k);
        return sum;
    };
    for (double v : {0.02, 0.1, 0.7, 5.0})
        for (double i : {-1.2, -0.3, 0.0, 0.8})
            for (double o : {-0.9, 0.1, 1.4}) {
                double a = std::cos(i) * std::cos(o) / v, b = std::sin(i) * std::sin(o) / v;
                double expected = std::exp(-b) * besselI0(a) / (2 * v * std::sinh(1 / v));
                Float found = LongitudinalDensity(Float(std::sin(i)), Float(std::cos(i)), Float(std::sin(o)),
                                                  Float(std::cos(o)), Float(v));
                EXPECT_NEAR(double(found), expected, 3e-5 * expected + 1e-12) << v << " " << i << " " << o;
            }
}

TEST(Hair, LogisticSamplesFollowTheirDensity) {
    constexpr int kCells = 64, kSamples = 50000;
    for (Float scale : {0.002f, 0.05f, 0.4f, 3.f}) {
        Float mass = LogisticMass(scale);
        std::vector<double> observed(kCells), expected(kCells);
        Rng rng(1);
        // The cells cover 15 scales to each side, at most the whole circle.
        double half = std::min(M_PI, 15 * double(scale)), total = 0;
        for (int s = 0; s < kSamples; ++s) {
            double x = double(SampleTrimmedLogistic(rng.Uniform(), scale, mass));
            int cell = int((x + half) / (2 * half) * kCells);
            ++observed[size_t(std::clamp(cell, 0, kCells - 1))];
        }
        constexpr int kSub = 50;
        for (int i = 0; i < kCells * kSub; ++i) {
            double x = half * (2 * (i + 0.5) / (kCells * kSub) - 1), w = 2 * half / (kCells * kSub);
            double p = double(TrimmedLogistic(Float(x), scale, mass)) * w;
            total += p;
            expected[size_t(i / kSub)] += p * kSamples;
        }
        EXPECT_NEAR(total, 1, 1e-4) << scale;
        EXPECT_GT(ChiSquareTest(observed, expected), 1e-5) << scale;
    }
}

TEST(Hair, SamplesFollowTheirDensity) {
    constexpr size_t kCases = 2 * 2 * 3 * 5;
    const double level = SidakAlpha(1e-4, kCases);
    ForEachHair({0.3f, 0.8f}, [&](Float betaM, Float betaN, Float offset) {
        HairBxdf hair(offset, 1.55f, Values(0.1f, 0.3f, 0.6f, 1.5f), betaM, betaN, 3);
        for (const Vector3 &wo : HairViews()) {
            double mass;
            double p = DirectionTest([&](Rng &rng) { return DirectionOf(SampleLobe(hair, wo, rng, kRadiance)); },
                                     [&](const Vector3 &wi) { return hair.Pdf(wo, wi, kRadiance); }, 10000, 8, &mass);
            EXPECT_GT(p, level) << betaM << " " << betaN << " " << offset;
            EXPECT_NEAR(mass, 1, 0.01) << betaM << " " << betaN << " " << offset;
        }
    });
}

TEST(Hair, SampleAgreesWithFAndPdf) {
    Rng rng(3);
    ForEachHair({0.02f, 0.1f, 0.5f, 1.f}, [&](Float betaM, Float betaN, Float offset) {
        HairBxdf hair(offset, 1.45f, Values(0.1f, 0, 0.6f, 4), betaM, betaN, 3.5f);
        for (int i = 0; i < 100; ++i) {
            Vector3 wo = SampleUniformSphere(rng.Uniform2());
            const bool isOnLightPath = i % 2;
            const TransportMode mode = isOnLightPath ? TransportMode::Importance : kRadiance;
            auto s = SampleLobe(hair, wo, rng, mode);
            ASSERT_TRUE(s);
            EXPECT_NEAR(Length(s->wi), 1, 1e-5f);
            EXPECT_FLOAT_EQ(hair.Pdf(wo, s->wi, mode), s->pdf);
            EXPECT_EQ(IsReflective(s->flags), SameHemisphere(wo, s->wi));
            SampledSpectrum f = isOnLightPath ? hair.F(s->wi, wo, kRadiance) : hair.F(wo, s->wi, kRadiance);
            for (int k = 0; k < SpectrumSamples; ++k) EXPECT_FLOAT_EQ(f[k], s->f[k]);
            EXPECT_TRUE(std::isfinite(s->pdf) && s->pdf > 0 && !std::isnan(s->f.Average()));
        }
    });
}

/// Under white light from all directions, a fibre that absorbs nothing is as bright as the light. It is measured by
/// uniform directions (F alone) where the lobes are wide, and by the lobe's own samples, which then have weight 1 each.
TEST(Hair, WhiteFurnace) {
    Rng rng(4);
    ForEachHair({0.02f, 0.1f, 0.3f, 1.f}, [&](Float betaM, Float betaN, Float offset) {
        HairBxdf hair(offset, 1.55f, SampledSpectrum(0), betaM, betaN, 2);
        for (const Vector3 &wo : HairViews()) {
            for (int i = 0; i < 20; ++i) {
                auto s = SampleLobe(hair, wo, rng, kRadiance);
                ASSERT_TRUE(s);
                EXPECT_NEAR(WeightOf(*s), 1, 1e-3f);
            }
            if (betaM < 0.25f || betaN < 0.25f) continue;
            auto reflected = [&](const Vector3 &wi) { return hair.F(wo, wi, kRadiance)[0] * AbsCosTheta(wi); };
            EXPECT_NEAR(SphereIntegral(reflected, 8), 1, 0.01) << betaM << " " << betaN << " " << offset;
        }
    });
}

/// The light that all lobes send out is the sum of a geometric series over the crossings of the fibre.
TEST(Hair, AbsorptionTakesWhatTheCrossingsTake) {
    const Float offset = 0.35f, eta = 1.55f;
    const SampledSpectrum sigma = Values(0.05f, 0.3f, 1, 3);
    HairBxdf hair(offset, eta, sigma, 0.5f, 0.5f, 0);
    for (const Vector3 &wo : HairViews()) {
        double sinO = double(wo.x), cosO = std::sqrt(1 - sinO * sinO);
        double cosT = std::sqrt(1 - sinO * sinO / double(eta * eta));
        double index = std::sqrt(double(eta * eta) - sinO * sinO) / cosO;
        double path = 2 * std::sqrt(1 - Sqr(double(offset) / index)) / cosT;
        double fresnel = double(FresnelDielectric(Float(cosO * std::sqrt(1 - double(offset * offset))), eta));
        for (int k = 0; k < SpectrumSamples; ++k) {
            double inside = (1 - fresnel), out = fresnel;
            for (int crossing = 0; crossing < 100; ++crossing) {
                inside *= std::exp(-double(sigma[k]) * path);
                out += inside * (1 - fresnel);
                inside *= fresnel;
            }
            auto reflected = [&](const Vector3 &wi) { return hair.F(wo, wi, kRadiance)[k] * AbsCosTheta(wi); };
            EXPECT_NEAR(SphereIntegral(reflected, 8), out, 0.01 * out) << k;
        }
    }
}

/// Two directions can be exchanged if the fibre is hit on opposite sides of its middle, the directions are equally
/// steep and the scales are not tilted. (In general the model is not reciprocal, because the shares of the lobes depend
/// on the elevation of the view only.)
TEST(Hair, ReciprocalForEqualElevations) {
    Rng rng(6);
    for (int i = 0; i < 2000; ++i) {
        Float offset = 2 * rng.Uniform() - 1, sine = 1.9f * rng.Uniform() - 0.95f, cosine = std::sqrt(1 - sine * sine);
        Float a = 2 * Pi * rng.Uniform(), b = 2 * Pi * rng.Uniform();
        Vector3 wo(sine, cosine * std::cos(a), cosine * std::sin(a));
        Vector3 wi(i % 2 ? sine : -sine, cosine * std::cos(b), cosine * std::sin(b));
        if (std::abs(wi.z) < 0.05f || std::abs(wo.z) < 0.05f) continue;
        auto hair = [](Float h) { return HairBxdf(h, 1.55f, Values(0, 0.2f, 0.6f, 2), 0.4f, 0.4f, 0); };
        SampledSpectrum there = hair(offset).F(wo, wi, kRadiance) * AbsCosTheta(wi);
        SampledSpectrum back = hair(-offset).F(wi, wo, kRadiance) * AbsCosTheta(wo);
        for (int k = 0; k < SpectrumSamples; ++k) EXPECT_NEAR(there[k], back[k], 1e-3f * back[k] + 1e-6f);
    }
}

/// A smooth fibre, hit in its middle, mirrors the view along its axis; scales tilted by alpha move the mirrored
/// direction by 2 alpha.
TEST(Hair, MirroredLobeStandsWhereScalesSendIt) {
    for (Float alpha : {0.f, 3.f}) {
        HairBxdf hair(0, 1.55f, SampledSpectrum(1e4f), 0.05f, 0.1f, alpha);
        const Float thetaO = 20;
        Vector3 wo(std::sin(Radians(thetaO)), 0, std::cos(Radians(thetaO)));
        Float best = 0, where = 0;
        for (Float theta = -60; theta < 60; theta += 0.25f) {
            Vector3 wi(std::sin(Radians(theta)), 0, std::cos(Radians(theta)));
            Float f = hair.F(wo, wi, kRadiance)[0] * wi.z;
            if (f > best) best = f, where = theta;
        }
        EXPECT_NEAR(where, -(thetaO - 2 * alpha), 0.5f);
    }
}

TEST(Hair, ReflectanceBecomesAbsorptionAndExtremesStayFinite) {
    SampledSpectrum sigma = HairBxdf::AbsorptionOfReflectance(Values(1, 0.5f, 0.1f, 0), 0.3f);
    EXPECT_EQ(sigma[0], 0);
    EXPECT_LT(sigma[1], sigma[2]);
    EXPECT_TRUE(std::isfinite(sigma[3]));
    // The published fit at beta_n = 0.3.
    double fit = 5.969 - 0.215 * 0.3 + 2.532 * 0.09 - 10.73 * 0.027 + 5.574 * 0.0081 + 0.245 * 0.00243;
    EXPECT_NEAR(double(sigma[1]), Sqr(std::log(0.5) / fit), 1e-6);

    Rng rng(7);
    for (Float eta : {1.f, 1.3f, 2.5f, 0.7f})
        for (Float offset : {-1.f, 0.f, 1.f})
            for (const SampledSpectrum &s : {SampledSpectrum(0), SampledSpectrum(1e30f), SampledSpectrum(1)})
                for (const Vector3 &wo :
                     {Vector3(1, 0, 0), Vector3(0, 0, 1), Vector3(-0.8f, 0, 0.6f), Vector3(0, 1, 0)}) {
                    HairBxdf hair(offset, eta, s, 0.01f, 0.01f, 2);
                    auto sample = hair.Sample(wo, rng.Uniform(), rng.Uniform2(), kRadiance);
                    if (sample) {
                        EXPECT_FALSE(std::isnan(sample->f.Average()) || std::isnan(sample->pdf) ||
                                     std::isnan(sample->wi.x));
                    }
                    Vector3 wi = SampleUniformSphere(rng.Uniform2());
                    EXPECT_FALSE(std::isnan(hair.F(wo, wi, kRadiance).Average()));
                    EXPECT_FALSE(std::isnan(hair.Pdf(wo, wi, kRadiance)));
                }
}

}  // namespace
}  // namespace pbrt::test
