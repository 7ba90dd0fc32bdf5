#include "pbrt/bxdfs/fresnel.h"

#include <gtest/gtest.h>

#include <complex>

namespace pbrt {
namespace {

TEST(FresnelDielectric, KnownValues) {
    EXPECT_NEAR(FresnelDielectric(1, 1.5f), 0.04, 1e-6);
    EXPECT_NEAR(FresnelDielectric(-1, 1.5f), 0.04, 1e-6);
    EXPECT_NEAR(FresnelDielectric(0, 1.5f), 1, 1e-6);
    EXPECT_NEAR(FresnelDielectric(0.3f, 1), 0, 1e-12);
}

TEST(FresnelDielectric, TotalInternalReflectionBeyondTheCriticalAngle) {
    Float critical = std::sqrt(1 - 1 / Sqr(1.5f));
    EXPECT_EQ(FresnelDielectric(-(critical - 1e-3f), 1.5f), 1);
    EXPECT_LT(FresnelDielectric(-(critical + 1e-3f), 1.5f), 0.95f);
    EXPECT_LT(FresnelDielectric(critical - 1e-3f, 1.5f), 0.1f);
}

TEST(FresnelDielectric, ParallelPartVanishesAtBrewstersAngle) {
    // At Brewster's angle only the perpendicular part is reflected: R = ((n^2 - 1) / (n^2 + 1))^2 / 2.
    Float n = 1.7f, cosBrewster = 1 / std::sqrt(1 + n * n);
    EXPECT_NEAR(FresnelDielectric(cosBrewster, n), Sqr((n * n - 1) / (n * n + 1)) / 2, 1e-6);
}

TEST(FresnelDielectric, SameFromBothSidesOfARay) {
    for (Float c = 0.05f; c < 1; c += 0.05f) {
        Float cosT = std::sqrt(1 - (1 - c * c) / Sqr(1.5f));
        EXPECT_NEAR(FresnelDielectric(c, 1.5f), FresnelDielectric(-cosT, 1.5f), 2e-5) << c;
    }
}

TEST(FresnelConductor, AgreesWithTheDielectricWithoutAbsorption) {
    for (Float eta : {0.7f, 1.f, 1.3f, 2.4f})
        for (Float c = 0.0625f; c <= 1; c += 0.0625f)
            EXPECT_NEAR(FresnelConductor(c, eta, 0), FresnelDielectric(c, eta), 3e-5) << eta << ' ' << c;
}

TEST(FresnelConductor, GrazingLightIsReflected) {
    EXPECT_NEAR(FresnelConductor(0, 1.5f, 0), 1, 1e-4);
    EXPECT_NEAR(FresnelConductor(0, 0.2f, 3), 1, 1e-4);
    EXPECT_FALSE(std::isnan(FresnelConductor(0, 1, 0)));
}

// The reference: Fresnel's amplitudes by complex arithmetic in double precision.
double ComplexTwin(double c, double eta, double k) {
    std::complex<double> n(eta, k), s2 = 1 - c * c, cosT = std::sqrt(1.0 - s2 / (n * n));
    return (std::norm((n * c - cosT) / (n * c + cosT)) + std::norm((c - n * cosT) / (c + n * cosT))) / 2;
}

TEST(FresnelConductor, AgreesWithComplexArithmetic) {
    for (Float eta : {0.05f, 0.2f, 1.f, 1.5f, 4.f})
        for (Float k : {0.01f, 0.5f, 2.f, 8.f})
            for (Float c = 0; c <= 1; c += 0.0625f) {
                double r = double(FresnelConductor(c, eta, k));
                EXPECT_NEAR(r, ComplexTwin(double(c), double(eta), double(k)), 1e-4) << eta << ' ' << k << ' ' << c;
                EXPECT_LE(r, 1);
            }
}

TEST(FresnelConductor, ReflectanceParameterIsTheValueAtNormalIncidence) {
    for (Float r : {0.f, 0.1f, 0.5f, 0.9f, 0.9999f})
        EXPECT_NEAR(FresnelConductor(1, 1, 2 * std::sqrt(r) / std::sqrt(1 - r)), r, 1e-5);
}

TEST(Refract, ObeysSnellAndComesBack) {
    Normal3 n = Normalize(Vector3(0.3f, -0.2f, 0.8f));
    Vector3 w = Normalize(Vector3(-0.5f, 0.6f, 0.7f));
    Vector3 wt, back;
    Float etaRelative, etaBack;
    ASSERT_TRUE(Refract(w, n, 1.5f, &etaRelative, &wt));
    EXPECT_EQ(etaRelative, 1.5f);
    EXPECT_NEAR(Length(wt), 1, 1e-5);
    EXPECT_NEAR(Length(Cross(w, n)), 1.5f * Length(Cross(wt, n)), 1e-5);
    EXPECT_LT(Dot(wt, n), 0);
    EXPECT_NEAR(Dot(Cross(w, n), wt), 0, 1e-6);
    ASSERT_TRUE(Refract(wt, n, 1.5f, &etaBack, &back));
    EXPECT_FLOAT_EQ(etaBack, 1 / 1.5f);
    EXPECT_NEAR(Distance(back, w), 0, 1e-5);
}

TEST(Refract, FailsExactlyUnderTotalReflection) {
    for (Float c = -0.99f; c < 1; c += 0.02f) {
        Vector3 w(std::sqrt(1 - c * c), 0, c), wt;
        EXPECT_EQ(Refract(w, {0, 0, 1}, 1.5f, nullptr, &wt), FresnelDielectric(c, 1.5f) < 1) << c;
    }
}

}  // namespace
}  // namespace pbrt
