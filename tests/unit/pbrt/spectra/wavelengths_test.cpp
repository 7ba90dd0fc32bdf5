#include <gtest/gtest.h>

#include <vector>

#include "pbrt/math/rng.h"
#include "pbrt/spectra/spectrum.h"
#include "support/statistics.h"

namespace pbrt::test {
namespace {

/// The density as the paper and the format reference state it.
double VisibleDensity(double lambda) {
    double c = std::cosh(0.0072 * (lambda - 538));
    return 0.0039398042 / (c * c);
}

TEST(SampledWavelengths, VisiblePdfIsTheStatedDensity) {
    for (int i = 0; i <= 1000; ++i) {
        SampledWavelengths s = SampledWavelengths::SampleVisible(Float(i) / 1000);
        for (int k = 0; k < SpectrumSamples; ++k) {
            ASSERT_GE(s[k], LambdaMin);
            ASSERT_LE(s[k], LambdaMax);
            EXPECT_NEAR(double(s.PdfAt(k)) / VisibleDensity(double(s[k])), 1, 2e-3) << s[k];
        }
    }
}

TEST(SampledWavelengths, FrequenciesMatchPdf) {
    Rng rng(7);
    constexpr int kBins = 47, kDraws = 50000;
    for (bool visible : {true, false}) {
        std::vector<double> observed(kBins, 0), expected(kBins, 0);
        for (int i = 0; i < kDraws; ++i) {
            Float u = rng.Uniform();
            SampledWavelengths s =
                visible ? SampledWavelengths::SampleVisible(u) : SampledWavelengths::SampleUniform(u);
            // Only one of the four wavelengths of each draw is used: they are stratified, so not independent.
            Float lambda = s[i % SpectrumSamples];
            observed[size_t(std::min(kBins - 1, int((lambda - 360) / 10)))] += 1;
        }
        for (int b = 0; b < kBins; ++b)
            for (int j = 0; j < 100; ++j) {
                double lambda = 360 + b * 10 + (j + 0.5) * 0.1;
                expected[size_t(b)] += kDraws * 0.1 * (visible ? VisibleDensity(lambda) : 1 / 470.0);
            }
        EXPECT_GT(ChiSquareTest(observed, expected), 1e-4) << visible;
    }
}

TEST(SampledWavelengths, TheFourAreStratified) {
    // Mapped by the cumulative distribution, the four wavelengths must lie 1/4 apart (with wrap-around).
    auto cdf = [](Float lambda) { return (0.85691062 + std::tanh(0.0072 * (double(lambda) - 538))) / 1.82750197; };
    for (Float u : {Float(0), Float(0.1), Float(0.3), Float(0.62), Float(0.99)}) {
        SampledWavelengths s = SampledWavelengths::SampleVisible(u);
        for (int k = 0; k < SpectrumSamples; ++k) {
            double wanted = double(u) + k * 0.25;
            EXPECT_NEAR(cdf(s[k]), wanted > 1 ? wanted - 1 : wanted, 1e-4);
        }
    }
}

TEST(SampledWavelengths, TerminateSecondaryKeepsTheMean) {
    Rng rng(3);
    RunningStatistics all, first;
    for (int i = 0; i < 200000; ++i) {
        SampledWavelengths s = SampledWavelengths::SampleVisible(rng.Uniform());
        EXPECT_FALSE(s.SecondaryTerminated());
        all.Add(double(SafeDivide(CieY().Sample(s), s.Pdf()).Average()));
        s.TerminateSecondary();
        EXPECT_TRUE(s.SecondaryTerminated());
        s.TerminateSecondary();
        first.Add(double(SafeDivide(CieY().Sample(s), s.Pdf()).Average()));
    }
    EXPECT_LT(std::abs(all.Z(double(CieYIntegral))), 4);
    EXPECT_LT(std::abs(first.Z(double(CieYIntegral))), 4);
    EXPECT_LT(all.Variance(), first.Variance());
}

}  // namespace
}  // namespace pbrt::test
