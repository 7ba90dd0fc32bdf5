#include <fmt/format.h>
#include <gtest/gtest.h>

#include <span>

#include "pbrt/bxdfs/boundaries.h"
#include "pbrt/bxdfs/diffuse.h"
#include "pbrt/bxdfs/fresnel.h"
#include "sphere_histogram.h"

namespace pbrt::test {
namespace {

constexpr TransportMode kImportance = TransportMode::Importance;
constexpr ReflTransFlags kSides[] = {ReflTransFlags::Reflection, ReflTransFlags::Transmission, ReflTransFlags::All};

/// The sides to sample.
template <class Lobe>
std::span<const ReflTransFlags> SidesOf(const Lobe &) {
    return std::span(kSides).last(std::is_same_v<Lobe, DielectricBxdf> ? 3 : 1);
}
template <class Lobe>
auto SampleSides(const Lobe &lobe, const Vector3 &wo, Rng &rng, TransportMode mode,
                 [[maybe_unused]] ReflTransFlags which) {
    if constexpr (std::is_same_v<Lobe, DielectricBxdf>) return SampleLobe(lobe, wo, rng, mode, which);
    else return SampleLobe(lobe, wo, rng, mode);
}
template <class Lobe>
Float PdfOfSides(const Lobe &lobe, const Vector3 &wo, const Vector3 &wi, TransportMode mode,
                 [[maybe_unused]] ReflTransFlags which) {
    if constexpr (std::is_same_v<Lobe, DielectricBxdf>) return lobe.Pdf(wo, wi, mode, which);
    else return lobe.Pdf(wo, wi, mode);
}

ConductorBxdf Gold(Float ax, Float ay) {
    return {TrowbridgeReitz(ax, ay), Values(1.3f, 0.6f, 0.2f, 0.15f), Values(1.9f, 2.f, 3.1f, 3.9f)};
}

/// A conductor at the limit of total reflection.
ConductorBxdf PerfectMirrorFacets(Float ax, Float ay) {
    return {TrowbridgeReitz(ax, ay), SampledSpectrum(1), SampledSpectrum(1e6f)};
}

struct Alphas {
    Float x, y;
};
constexpr Alphas kAlphas[] = {{0.15f, 0.15f}, {0.2f, 0.7f}, {0.5f, 0.5f}, {1, 1}};
constexpr Float kIndices[] = {1 / 2.4f, 1 / 1.5f, 1.1f, 1.3f, 1.5f, 2.4f};

/// Calls check(name, lobe) for every lobe that is not specular, over a grid of parameters.
template <class Check>
void ForEachNonSpecular(Check check) {
    check("diffuse", DiffuseBxdf(Values(0.2f, 0.4f, 0.6f, 0.8f)));
    check("diffuse transmission", DiffuseTransmissionBxdf(SampledSpectrum(0.2f), Values(0.1f, 0.3f, 0.6f, 0.2f)));
    for (auto [x, y] : kAlphas) {
        check(fmt::format("conductor {} {}", x, y).c_str(), Gold(x, y));
        for (Float eta : kIndices)
            check(fmt::format("dielectric {} {} {}", eta, x, y).c_str(), DielectricBxdf(eta, TrowbridgeReitz(x, y)));
    }
}

constexpr size_t kLobes = 2 + std::size(kAlphas) * (1 + std::size(kIndices));
const std::vector<Vector3> &Views() {
    static const std::vector<Vector3> views = {DirectionAt(0, 0),   DirectionAt(35, 20),   DirectionAt(65, 200),
                                               DirectionAt(84, 75), DirectionAt(150, 120), DirectionAt(108, 300)};
    return views;
}

TEST(Lobes, SamplesFollowTheirDensity) {
    double level = SidakAlpha(1e-4, kLobes * Views().size() * 3);
    ForEachNonSpecular([&](const char *name, const auto &lobe) {
        for (const Vector3 &wo : Views())
            for (ReflTransFlags which : SidesOf(lobe)) {
                auto draw = [&](Rng &rng) { return DirectionOf(SampleSides(lobe, wo, rng, kRadiance, which)); };
                auto pdf = [&](const Vector3 &wi) { return PdfOfSides(lobe, wo, wi, kRadiance, which); };
                // Refraction at grazing angles has ridges that only a fine quadrature integrates well; the finest is
                // needed for index 1.1, where all facets send light almost straight on.
                double p = 0, mass = 2;
                for (auto [quadrature, fine] : {std::pair(16, 0), {16, 80}, {80, 320}})
                    if (!(p > level && mass <= 1.01)) p = DirectionTest(draw, pdf, 20000, quadrature, &mass, fine);
                EXPECT_GT(p, level) << name << " theta " << SafeACos(wo.z) / Radians(1) << " sides " << int(which);
                EXPECT_LE(mass, 1.01) << name;
            }
    });
}

TEST(Lobes, PdfIntegratesToOneWhereNothingIsLost) {
    auto mass = [](const auto &lobe, const Vector3 &wo, ReflTransFlags which = ReflTransFlags::All) {
        return SphereIntegral([&](const Vector3 &wi) { return PdfOfSides(lobe, wo, wi, kRadiance, which); }, 10);
    };
    for (const Vector3 &wo : Views()) {
        EXPECT_NEAR(mass(DiffuseBxdf(SampledSpectrum(0.5f)), wo), 1, 2e-3);
        DiffuseTransmissionBxdf leaf(SampledSpectrum(0.2f), SampledSpectrum(0.6f));
        EXPECT_NEAR(mass(leaf, wo), 1, 2e-3);
    }
    // A weakly rough surface, seen from above, reflects almost nothing below the horizon.
    Vector3 above = DirectionAt(1, 70);
    EXPECT_NEAR(mass(Gold(0.12f, 0.08f), above), 1, 0.015);
    for (ReflTransFlags which : kSides)
        EXPECT_NEAR(mass(DielectricBxdf(1.5f, TrowbridgeReitz(0.12f, 0.08f)), above, which), 1, 0.015);
}

TEST(Lobes, WhatWalksDrawAtABoundaryAgreesWithFAndPdf) {
    Rng rng(4);
    for (const DielectricBxdf &lobe :
         {DielectricBxdf(1.5f, TrowbridgeReitz(0.3f, 0.3f)), DielectricBxdf(0.7f, TrowbridgeReitz(0.2f, 0.6f))})
        for (int i = 0; i < 2000; ++i) {
            const Vector3 wo = SampleUniformSphere(rng.Uniform2());
            const TransportMode mode = i % 2 ? kRadiance : kImportance;
            const Point2 u = rng.Uniform2();
            auto expect = [&](const DielectricBxdf::Drawn &drawn, ReflTransFlags which, const char *name) {
                if (!(drawn.weight > 0)) return;
                const Float pdf = lobe.Pdf(wo, drawn.wi, mode, which);
                const Float weight = lobe.F(wo, drawn.wi, mode)[0] * AbsCosTheta(drawn.wi) / pdf;
                EXPECT_NEAR(drawn.weight / weight, 1, 3e-3f) << name;
                EXPECT_EQ(drawn.isTransmitted, !SameHemisphere(wo, drawn.wi)) << name;
                if (which != ReflTransFlags::Transmission) return;
                EXPECT_NEAR(drawn.pdf / pdf, 1, 1e-2f);
                const DielectricBxdf::Transmission both = lobe.EvaluateTransmission(wo, drawn.wi, mode);
                EXPECT_NEAR(both.f / lobe.F(wo, drawn.wi, mode)[0], 1, 1e-5f);
                EXPECT_NEAR(both.pdf / pdf, 1, 1e-5f);
            };
            expect(lobe.DrawReflection(wo, u), ReflTransFlags::Reflection, "reflection");
            expect(lobe.DrawTransmission(wo, u, mode), ReflTransFlags::Transmission, "transmission");
            expect(lobe.DrawEither(wo, rng.Uniform(), u, mode), ReflTransFlags::All, "either");
        }
    const DielectricBxdf smooth(1.5f, TrowbridgeReitz(0, 0));
    for (int i = 0; i < 200; ++i) {
        const Vector3 wo = SampleUniformSphere(rng.Uniform2());
        const Float uc = rng.Uniform();
        const auto sample = smooth.Sample(wo, uc, {}, kRadiance, ReflTransFlags::All);
        const DielectricBxdf::Drawn drawn = smooth.DrawEither(wo, uc, {}, kRadiance);
        ASSERT_TRUE(sample);
        EXPECT_NEAR(drawn.weight, WeightOf(*sample), 1e-5f);
        EXPECT_LT(Distance(drawn.wi, sample->wi), 1e-5f);
    }
}

TEST(Lobes, SampleAgreesWithFAndPdf) {
    Rng rng(3);
    ForEachNonSpecular([&](const char *name, const auto &lobe) {
        EXPECT_TRUE(IsNonSpecular(lobe.Flags())) << name;
        EXPECT_FALSE(IsSpecular(lobe.Flags())) << name;
        int drawn = 0;
        for (int i = 0; i < 2000; ++i) {
            Vector3 wo = SampleUniformSphere(rng.Uniform2());
            TransportMode mode = i % 2 ? kRadiance : kImportance;
            ReflTransFlags which = SidesOf(lobe)[i % SidesOf(lobe).size()];
            auto s = SampleSides(lobe, wo, rng, mode, which);
            // Near the horizon directions in float are too coarse for the half vector of a refraction.
            if (!s || std::abs(s->wi.z) < 0.02f || std::abs(wo.z) < 0.02f) continue;
            ++drawn;
            Float pdf = PdfOfSides(lobe, wo, s->wi, mode, which);
            EXPECT_NEAR(pdf / s->pdf, 1, 5e-3) << name;
            SampledSpectrum f = lobe.F(wo, s->wi, mode);
            for (int k = 0; k < SpectrumSamples; ++k) EXPECT_NEAR(f[k] / s->f[k], 1, 5e-3) << name;
            EXPECT_EQ(SameHemisphere(wo, s->wi), IsReflective(s->flags)) << name;
            EXPECT_NE(IsReflective(s->flags), IsTransmissive(s->flags)) << name;
            EXPECT_TRUE(Has(which, IsReflective(s->flags) ? ReflTransFlags::Reflection : ReflTransFlags::Transmission));
            EXPECT_FALSE(s->pdfIsProportional);
        }
        EXPECT_GT(drawn, 300) << name;
    });
}

// f_r(a, b) = f_r(b, a). Across a boundary, the function for radiance in one direction is that for importance in the
// other, and radiance carries the squared index (Veach 1997, section 5.2).
TEST(Lobes, Reciprocal) {
    Rng rng(4);
    ForEachNonSpecular([&](const char *name, const auto &lobe) {
        int compared = 0;
        for (int i = 0; i < 3000; ++i) {
            Vector3 a = SampleUniformSphere(rng.Uniform2()), b = SampleUniformSphere(rng.Uniform2());
            if (std::abs(a.z) < 0.05f || std::abs(b.z) < 0.05f) continue;
            SampledSpectrum there = lobe.F(a, b, kRadiance), back = lobe.F(b, a, kImportance);
            for (int k = 0; k < SpectrumSamples; ++k) {
                if (there[k] < 1e-5f && back[k] < 1e-5f) continue;
                ++compared;
                // The Fresnel terms are steep near the critical angle.
                EXPECT_NEAR(there[k], back[k], 0.02f * back[k] + 1e-4f) << name;
            }
        }
        EXPECT_GT(compared, 500) << name;
    });
}

/// The mean of |f cos / pdf| over samples: the share of light from everywhere that is scattered.
template <class Lobe>
double Albedo(const Lobe &lobe, const Vector3 &wo, TransportMode mode, int n = 40000) {
    Rng rng(5);
    double sum = 0;
    for (int i = 0; i < n; ++i)
        if (auto s = SampleLobe(lobe, wo, rng, mode)) sum += double(s->f.MaxComponent() * AbsCosTheta(s->wi) / s->pdf);
    return sum / n;
}

TEST(Lobes, ConserveEnergy) {
    for (const Vector3 &wo : Views()) {
        EXPECT_NEAR(Albedo(DiffuseBxdf(SampledSpectrum(1)), wo, kRadiance), 1, 1e-4);
        EXPECT_NEAR(Albedo(DiffuseTransmissionBxdf(SampledSpectrum(0.3f), SampledSpectrum(0.7f)), wo, kRadiance), 1,
                    1e-4);
        EXPECT_NEAR(Albedo(DielectricBxdf(1.5f, TrowbridgeReitz(0, 0)), wo, kImportance), 1, 1e-4);
        EXPECT_NEAR(Albedo(ThinDielectricBxdf(1.5f), wo, kRadiance), 1, 1e-4);
        EXPECT_NEAR(Albedo(PerfectMirrorFacets(0, 0), wo, kRadiance), 1, 1e-4);
        for (Float alpha : {0.05f, 0.3f, 1.f}) {
            double metal = Albedo(PerfectMirrorFacets(alpha, alpha), wo, kRadiance);
            EXPECT_LE(metal, 1.0001);
            double glass = Albedo(DielectricBxdf(1.5f, TrowbridgeReitz(alpha, alpha)), wo, kImportance);
            EXPECT_LE(glass, 1.0001);
            if (alpha < 0.1f && std::abs(wo.z) > 0.5f) {
                EXPECT_GT(metal, 0.99);
                EXPECT_GT(glass, 0.99);
            }
        }
    }
}

/// The share of white light that is not shadowed by facets after it was scattered once, by quadrature over the visible
/// normals. `fresnel(cosine)` is the share that is mirrored; the rest is refracted by `eta`.
template <class Fresnel>
double KeptByFacets(const TrowbridgeReitz &facets, const Vector3 &wo, Float eta, Fresnel fresnel) {
    return SphereIntegral(
        [&](const Vector3 &wm) -> Float {
            if (wm.z <= 0 || Dot(wo, wm) * wo.z <= 0) return 0;
            auto seen = [&](const Vector3 &wi) { return facets.G(wo, wi) / facets.G1(wo); };
            Float r = fresnel(Dot(wo, wm)), kept = 0;
            Vector3 mirrored = Reflect(wo, wm), through;
            if (SameHemisphere(wo, mirrored)) kept += r * seen(mirrored);
            if (r < 1 && Refract(wo, wm, eta, nullptr, &through) && !SameHemisphere(wo, through))
                kept += (1 - r) * seen(through);
            return kept * facets.VisiblePdf(wo, wm);
        },
        16);
}

TEST(Lobes, RoughOnesLoseExactlyWhatFacetsHide) {
    for (auto [x, y] : kAlphas) {
        TrowbridgeReitz facets(x, y);
        for (const Vector3 &wo : Views()) {
            double metal = KeptByFacets(facets, wo, 1, [](Float) { return Float(1); });
            EXPECT_NEAR(Albedo(PerfectMirrorFacets(x, y), wo, kRadiance), metal, 0.01) << x << ' ' << y << ' ' << wo.z;
            for (Float eta : kIndices) {
                double glass = KeptByFacets(facets, wo, eta, [&](Float c) { return FresnelDielectric(c, eta); });
                EXPECT_NEAR(Albedo(DielectricBxdf(eta, facets), wo, kImportance), glass, 0.012)
                    << eta << ' ' << x << ' ' << y << ' ' << wo.z;
            }
        }
    }
}

TEST(SmoothDielectric, DrawsByFresnelsSharesAndCompressesRadiance) {
    DielectricBxdf glass(1.5f, TrowbridgeReitz(0, 0));
    EXPECT_TRUE(IsSpecular(glass.Flags()) && IsReflective(glass.Flags()) && IsTransmissive(glass.Flags()));
    Vector3 wo = DirectionAt(50, 30);
    Float r = FresnelDielectric(wo.z, 1.5f);
    auto mirror = glass.Sample(wo, r * 0.99f, {}, kRadiance, ReflTransFlags::All);
    ASSERT_TRUE(mirror && IsReflective(mirror->flags) && IsSpecular(mirror->flags));
    EXPECT_FLOAT_EQ(mirror->pdf, r);
    EXPECT_EQ(mirror->wi, Vector3(-wo.x, -wo.y, wo.z));
    EXPECT_EQ(mirror->eta, 1);
    auto through = glass.Sample(wo, r * 1.01f, {}, kRadiance, ReflTransFlags::All);
    ASSERT_TRUE(through && IsTransmissive(through->flags));
    EXPECT_FLOAT_EQ(through->pdf, 1 - r);
    EXPECT_FLOAT_EQ(through->eta, 1.5f);
    EXPECT_FLOAT_EQ(through->f[0] * AbsCosTheta(through->wi) / through->pdf, 1 / Sqr(1.5f));
    auto importance = glass.Sample(wo, r * 1.01f, {}, kImportance, ReflTransFlags::All);
    EXPECT_FLOAT_EQ(importance->f[0] * AbsCosTheta(importance->wi) / importance->pdf, 1);
    auto forced = glass.Sample(wo, 0, {}, kRadiance, ReflTransFlags::Transmission);
    ASSERT_TRUE(forced && IsTransmissive(forced->flags));
    EXPECT_EQ(forced->pdf, 1);
    // From inside, beyond the critical angle, nothing is transmitted.
    EXPECT_FALSE(glass.Sample(-wo, 0.5f, {}, kRadiance, ReflTransFlags::Transmission));
}

TEST(SmoothDielectric, EqualIndicesLetEverythingPass) {
    DielectricBxdf nothing(1, TrowbridgeReitz(0.5f, 0.5f));
    EXPECT_FALSE(IsReflective(nothing.Flags()));
    EXPECT_TRUE(IsSpecular(nothing.Flags()));
    Vector3 wo = DirectionAt(40, 10);
    auto s = nothing.Sample(wo, 0, {0.3f, 0.4f}, kRadiance, ReflTransFlags::All);
    ASSERT_TRUE(s && IsTransmissive(s->flags));
    EXPECT_NEAR(Distance(s->wi, -wo), 0, 1e-6);
    EXPECT_FALSE(nothing.F(wo, -wo, kRadiance));
    EXPECT_FALSE(nothing.Sample(wo, 0, {0.3f, 0.4f}, kRadiance, ReflTransFlags::Reflection));
}

// The reference: the bounces inside of the pane, one by one.
TEST(ThinDielectric, SumsTheBouncesInside) {
    ThinDielectricBxdf pane(1.5f);
    for (Float theta : {0.f, 45.f, 80.f}) {
        Vector3 wo = DirectionAt(theta, 60);
        double r = double(FresnelDielectric(wo.z, 1.5f)), reflected = r, inside = (1 - r), through = 0;
        for (int bounce = 0; bounce < 200; ++bounce) {
            (bounce % 2 ? reflected : through) += inside * (1 - r);
            inside *= r;
        }
        auto mirror = pane.Sample(wo, 0, {}, kRadiance);
        auto straight = pane.Sample(wo, OneMinusEpsilon, {}, kRadiance);
        ASSERT_TRUE(mirror && straight);
        EXPECT_NEAR(double(mirror->pdf), reflected, 1e-5);
        EXPECT_NEAR(double(mirror->f[0] * AbsCosTheta(mirror->wi)), reflected, 1e-5);
        EXPECT_NEAR(double(straight->pdf), through, 1e-5);
        EXPECT_EQ(straight->wi, -wo);
        EXPECT_EQ(straight->eta, 1);
    }
}

TEST(DiffuseTransmission, SidesAreDrawnByTheLargestValues) {
    DiffuseTransmissionBxdf leaf(Values(0.1f, 0.2f, 0.3f, 0.1f), Values(0.6f, 0.1f, 0.1f, 0.1f));
    Vector3 wo = DirectionAt(30, 0);
    auto r = leaf.Sample(wo, 0.3333f, {0.3f, 0.7f}, kRadiance);
    auto t = leaf.Sample(wo, 0.3334f, {0.3f, 0.7f}, kRadiance);
    ASSERT_TRUE(r && t);
    EXPECT_GT(r->wi.z, 0);
    EXPECT_LT(t->wi.z, 0);
    EXPECT_FLOAT_EQ(r->f[2], 0.3f * InvPi);
    EXPECT_FLOAT_EQ(t->f[0], 0.6f * InvPi);
}

TEST(Lobes, FlagsSeparateSmoothFromRough) {
    EXPECT_EQ(Gold(0, 0).Flags(), BxdfFlags::Reflection | BxdfFlags::Specular);
    EXPECT_EQ(Gold(0, 0.1f).Flags(), BxdfFlags::Reflection | BxdfFlags::Glossy);
    EXPECT_EQ(DiffuseBxdf(SampledSpectrum(0)).Flags(), BxdfFlags::None);
    EXPECT_EQ(DiffuseTransmissionBxdf(SampledSpectrum(0), SampledSpectrum(0.1f)).Flags(),
              BxdfFlags::Transmission | BxdfFlags::Diffuse);
    ConductorBxdf gold = Gold(0, 0);
    gold.Regularize();
    EXPECT_EQ(gold.Flags(), BxdfFlags::Reflection | BxdfFlags::Glossy);
}

}  // namespace
}  // namespace pbrt::test
