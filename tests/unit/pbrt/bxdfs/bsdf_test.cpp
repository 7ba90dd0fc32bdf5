#include "pbrt/bxdfs/bsdf.h"

#include <gtest/gtest.h>

#include "pbrt/math/rng.h"

namespace pbrt {
namespace {

const Normal3 kNormal = Normalize(Vector3(0.3f, -0.7f, 0.4f));
const Vector3 kTangent(1, 0.2f, -0.1f);

template <class Lobe>
Bsdf Upright(const Lobe &lobe) {
    return Bsdf(Normal3(0, 0, 1), Vector3(1, 0, 0), lobe);
}

TEST(Bsdf, WithoutLobeNothingScatters) {
    Bsdf none;
    EXPECT_FALSE(none);
    EXPECT_EQ(none.Flags(), BxdfFlags::None);
    EXPECT_FALSE(none.Sample(kNormal, 0.5f, {0.5f, 0.5f}));
    EXPECT_FALSE(none.F(kNormal, kNormal));
    EXPECT_EQ(none.Pdf(kNormal, kNormal), 0);
    none.Regularize();
}

TEST(Bsdf, WorksInTheShadingFrame) {
    DielectricBxdf lobe(1.4f, TrowbridgeReitz(0.2f, 0.6f));
    Bsdf bsdf(kNormal, kTangent, lobe);
    EXPECT_TRUE(bsdf);
    Frame frame = Frame::FromXZ(kTangent, kNormal);
    Rng rng(1);
    for (int i = 0; i < 200; ++i) {
        Vector3 wo = SampleUniformSphere(rng.Uniform2()), wi = SampleUniformSphere(rng.Uniform2());
        Vector3 o = frame.ToLocal(wo), local = frame.ToLocal(wi);
        // The last bits may differ: the compiler may contract products and sums in one place and not in the other.
        Float f = lobe.F(o, local, TransportMode::Radiance)[1];
        Float pdf = lobe.Pdf(o, local, TransportMode::Radiance);
        EXPECT_NEAR(bsdf.F(wo, wi)[1], f, 1e-4f * f);
        EXPECT_NEAR(bsdf.Pdf(wo, wi), pdf, 1e-4f * pdf);
        Float uc = rng.Uniform();
        Point2 u = rng.Uniform2();
        auto s = bsdf.Sample(wo, uc, u);
        auto expected = lobe.Sample(o, uc, u, TransportMode::Radiance);
        ASSERT_EQ(s.has_value(), expected.has_value());
        if (!s) continue;
        EXPECT_NEAR(Distance(frame.ToLocal(s->wi), expected->wi), 0, 1e-5);
        EXPECT_NEAR(s->pdf, expected->pdf, 1e-4f * s->pdf);
    }
}

TEST(Bsdf, HorizontalViewAndBlackGiveNothing) {
    Bsdf diffuse = Upright(DiffuseBxdf(SampledSpectrum(0.5f)));
    Vector3 flat(1, 0, 0), up(0, 0, 1);
    EXPECT_FALSE(diffuse.F(flat, up));
    EXPECT_FALSE(diffuse.Sample(flat, 0.5f, {0.4f, 0.6f}));
    EXPECT_EQ(diffuse.Pdf(flat, up), 0);
    EXPECT_EQ(diffuse.Pdf(up, -up), 0);
    EXPECT_TRUE(diffuse.Sample(up, 0.5f, {0.4f, 0.6f}));
    Bsdf black = Upright(DiffuseBxdf(SampledSpectrum(0)));
    EXPECT_FALSE(black.Sample(up, 0.5f, {0.4f, 0.6f}));
}

TEST(Bsdf, EveryLobeIsDispatched) {
    TrowbridgeReitz rough(0.3f, 0.3f), smooth(0, 0);
    DielectricBxdf coat(1.5f, smooth);
    SampledSpectrum half(0.5f), zero(0);
    DiffuseBxdf paint(half);
    ConductorBxdf metal(rough, half, half);
    auto flags = [](const auto &lobe) { return Upright(lobe).Flags(); };
    using enum BxdfFlags;
    EXPECT_EQ(flags(paint), Diffuse | Reflection);
    EXPECT_EQ(flags(DiffuseTransmissionBxdf(half, half)), Diffuse | Reflection | Transmission);
    EXPECT_EQ(flags(metal), Glossy | Reflection);
    EXPECT_EQ(flags(coat), Specular | Reflection | Transmission);
    EXPECT_EQ(flags(ThinDielectricBxdf(1.5f)), Specular | Reflection | Transmission);
    EXPECT_EQ(flags(CoatedDiffuseBxdf(coat, paint, 0.01f, zero, 0, 10, 1)), Specular | Diffuse | Reflection);
    EXPECT_EQ(flags(CoatedConductorBxdf(coat, metal, 0.01f, zero, 0, 10, 1)), Specular | Glossy | Reflection);
    EXPECT_EQ(flags(CoatedConductorBxdf(coat, metal, 0.01f, half, 0, 10, 1)), Specular | Diffuse | Reflection);
}

/// The ratio of F to its approximation stays within a factor over all directions; it is 1 for lobes whose approximation
/// leaves nothing out.
TEST(Bsdf, ApproximateFFollowsF) {
    SampledSpectrum colored(0.2f);
    colored[0] = 0.8f;
    const SampledSpectrum none(0);
    const TrowbridgeReitz rough(0.3f, 0.5f);
    const DiffuseBxdf paint(colored);
    const ConductorBxdf metal(rough, SampledSpectrum(0.3f), SampledSpectrum(3.5f));
    auto factorRange = [](const auto &lobe, Float largest, Float whereAbove) {
        const Bsdf bsdf(kNormal, kTangent, lobe);
        Rng rng(3);
        Float low = Infinity, high = 0;
        for (int i = 0; i < 100; ++i) {
            Vector3 wo = SampleUniformSphere(rng.Uniform2()), wi[2];
            for (Vector3 &w : wi) w = SampleUniformSphere(rng.Uniform2());
            Float f[2];
            bsdf.ApproximateF(wo, wi, f);
            for (int k = 0; k < 2; ++k) {
                Float expected = 0;
                constexpr int kRuns = 100;  // F of layers is a random estimate
                for (int r = 0; r < kRuns; ++r)
                    expected += bsdf.F(wo, Normalize(wi[k] + Vector3(1e-6f * Float(r)))).Average() / kRuns;
                EXPECT_GE(f[k], 0);
                if (!(expected > whereAbove) || AbsDot(wi[k], kNormal) < 0.1f || AbsDot(wo, kNormal) < 0.1f) continue;
                EXPECT_GT(f[k], 0);
                low = std::min(low, expected / f[k]);
                high = std::max(high, expected / f[k]);
            }
        }
        EXPECT_GT(high, 0);
        EXPECT_LT(high / low, largest);
        return high;
    };
    EXPECT_NEAR(factorRange(paint, 1.001f, 0), 1, 1e-3f);
    EXPECT_NEAR(factorRange(HairBxdf(0.3f, 1.55f, colored, 0.3f, 0.3f, 2), 1.01f, 1e-4f), 1, 0.01f);
    EXPECT_NEAR(factorRange(DielectricBxdf(1.5f, rough), 1.01f, 1e-4f), 1, 0.01f);
    EXPECT_LT(factorRange(metal, 1.3f, 1e-4f), 1);
    factorRange(CoatedDiffuseBxdf(DielectricBxdf(1.5f, rough), paint, 0.01f, none, 0, 10, 1), 3, 0.01f);
    factorRange(CoatedConductorBxdf(DielectricBxdf(1.5f, rough), metal, 0.01f, none, 0, 10, 1), 4, 0.05f);
}

TEST(Bsdf, RegularizeRoughensMirrors) {
    Bsdf mirror = Upright(ConductorBxdf(TrowbridgeReitz(0, 0), SampledSpectrum(0.5f), SampledSpectrum(2)));
    EXPECT_TRUE(IsSpecular(mirror.Flags()));
    mirror.Regularize();
    EXPECT_FALSE(IsSpecular(mirror.Flags()));
    EXPECT_TRUE(mirror.F(Vector3(0, 0, 1), Vector3(0, 0, 1)));
}

/// The ratio of ApproximateF to the mean of F over wavelengths, towards random directions; directions where both are 0
/// are left out.
std::vector<Float> ApproximateOverF(const Bsdf &bsdf, bool alsoBelow) {
    Rng rng(7);
    std::vector<Float> ratios;
    for (int t = 0; t < 20; ++t) {
        const Vector3 wo = SampleUniformHemisphere(rng.Uniform2());
        std::vector<Vector3> wi(10);
        for (Vector3 &w : wi) {
            const Point2 u = rng.Uniform2();
            w = alsoBelow ? SampleUniformSphere(u) : SampleUniformHemisphere(u);
        }
        std::vector<Float> f(wi.size());
        bsdf.ApproximateF(wo, wi, f.data());
        for (size_t k = 0; k < wi.size(); ++k) {
            const Float exact = bsdf.F(wo, wi[k]).Average();
            EXPECT_EQ(f[k] > 0, exact > 0);
            if (exact > 0) ratios.push_back(f[k] / exact);
        }
    }
    return ratios;
}

TEST(Bsdf, ApproximationIsFForGlassAndLacksTheReflectanceOfAMetal) {
    const std::vector<Float> ratios =
        ApproximateOverF(Upright(DielectricBxdf(1.5f, TrowbridgeReitz(0.3f, 0.3f))), true);
    EXPECT_GT(ratios.size(), 100u);
    for (Float r : ratios) EXPECT_NEAR(r, 1, 1e-4);
    const Bsdf metal =
        Upright(ConductorBxdf(TrowbridgeReitz(0.3f, 0.3f), SampledSpectrum(0.2f), SampledSpectrum(3.9f)));
    Float least = 1;
    for (int i = 0; i <= 1000; ++i) least = std::min(least, FresnelConductor(Float(i) / 1000, 0.2f, 3.9f));
    EXPECT_GT(least, 0.9f);
    for (Float r : ApproximateOverF(metal, false)) {
        EXPECT_GT(r, 0.9999f);
        EXPECT_LT(r, 1.0001f / least);
    }
}

TEST(Bsdf, ApproximationUnderASmoothCoatIsTheFirstBounce) {
    // The base is dark, so light of more bounces is 3 % at most. The coat is smooth, so only later bounces make F
    // noisy.
    const CoatedDiffuseBxdf coated(DielectricBxdf(1.5f, TrowbridgeReitz(0, 0)), DiffuseBxdf(SampledSpectrum(0.04f)),
                                   0.1f, SampledSpectrum(0), 0, 10, 64);
    const std::vector<Float> ratios = ApproximateOverF(Upright(coated), false);
    EXPECT_GT(ratios.size(), 100u);
    for (Float r : ratios) {
        EXPECT_GT(r, 0.94f);
        EXPECT_LT(r, 1.001f);
    }
}

}  // namespace
}  // namespace pbrt
