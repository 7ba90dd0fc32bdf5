#include "pbrt/bxdfs/fresnel.h"

#include <gtest/gtest.h>

#include <complex>

namespace pbrt {
namespace {

// The reference: Fresnel's amplitudes by complex arithmetic in double precision.
double ComplexTwin(double c, double eta, double k) {
    std::complex<double> n(eta, k), s2 = 1 - c * c, cosT = std::sqrt(1.0 - s2 / (n * n));
    return (std::norm((n * c - cosT) / (n * c + cosT)) + std::norm((c - n * cosT) / (c + n * cosT))) / 2;
}

/// Negative cosines are those of rays from inside, also beyond the critical angle.
TEST(FresnelDielectric, AgreesWithComplexArithmetic) {
    for (Float eta : {1 / 2.4f, 0.7f, 1.f, 1.3f, 1.5f, 2.4f})
        for (Float c = -1; c <= 1; c += 0.0625f) {
            if (c == 0) continue;
            const double inward = double(c > 0 ? eta : 1 / eta);
            EXPECT_NEAR(FresnelDielectric(c, eta), ComplexTwin(std::abs(double(c)), inward, 0), 3e-5)
                << eta << ' ' << c;
        }
    EXPECT_NEAR(FresnelDielectric(0, 1.5f), 1, 1e-6);
}

TEST(FresnelConductor, AgreesWithComplexArithmetic) {
    for (Float eta : {0.05f, 0.2f, 1.f, 1.5f, 4.f})
        for (Float k : {0.f, 0.01f, 0.5f, 2.f, 8.f})
            for (Float c = 0; c <= 1; c += 0.0625f) {
                if (eta == 1 && k == 0 && c == 0) continue;
                double r = double(FresnelConductor(c, eta, k));
                EXPECT_NEAR(r, ComplexTwin(double(c), double(eta), double(k)), 1e-4) << eta << ' ' << k << ' ' << c;
                EXPECT_LE(r, 1);
            }
    EXPECT_FALSE(std::isnan(FresnelConductor(0, 1, 0)));
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
