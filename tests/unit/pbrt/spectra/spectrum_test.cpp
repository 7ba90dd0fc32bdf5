#include "pbrt/spectra/spectrum.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "pbrt/math/rng.h"
#include "pbrt/spectra/rgb_primaries.h"

namespace pbrt {
namespace {

TEST(Cie, YIntegralIsTheUsualConstant) {
    EXPECT_NEAR(InnerProduct(CieY(), ConstantSpectrum(1)), CieYIntegral, 1e-3);
    EXPECT_NEAR(SpectrumToXyz(ConstantSpectrum(2)).y, 2, 1e-5);
    EXPECT_FLOAT_EQ(CieY()(555), 1.0f);
    EXPECT_NEAR(CieX()(600), 1.0622f, 1e-4);
    EXPECT_NEAR(CieZ()(445), 1.7826f, 1e-4);
}

TEST(NamedSpectra, IlluminantsHaveTheirPublishedChromaticities) {
    struct Row {
        const char *name;
        Float x, y;
    };
    // The value for stdillum-D50 is not a mistake: the table that stock pbrt-v4 ships differs from CIE's D50 (0.34567,
    // 0.35850), and its pictures show it (conformance scene color/reflectance_spectra, flat grey patch).
    for (const Row &row : {Row{"stdillum-A", 0.44757f, 0.40745f},
                           {"stdillum-D50", 0.33681f, 0.35798f},
                           {"stdillum-D65", 0.31272f, 0.32903f},
                           {"illum-acesD60", 0.32168f, 0.33767f},
                           {"stdillum-F1", 0.3131f, 0.3371f},
                           {"stdillum-F2", 0.3721f, 0.3751f},
                           {"stdillum-F7", 0.3129f, 0.3292f},
                           {"stdillum-F11", 0.3805f, 0.3769f},
                           {"stdillum-F12", 0.4370f, 0.4042f}}) {
        SpectrumPtr s = NamedSpectrum(row.name);
        ASSERT_TRUE(s) << row.name;
        Vector3 xyz = SpectrumToXyz(*s);
        EXPECT_NEAR(xyz.y, 1, 1e-5) << row.name;
        EXPECT_NEAR(Chromaticity(xyz).x, row.x, 4e-4) << row.name;
        EXPECT_NEAR(Chromaticity(xyz).y, row.y, 4e-4) << row.name;
    }
}

TEST(NamedSpectra, AllOfTheFormatExist) {
    std::vector<std::string> names = {"stdillum-A", "stdillum-D50", "stdillum-D65", "illum-acesD60"};
    for (int i = 1; i <= 12; ++i) names.push_back("stdillum-F" + std::to_string(i));
    for (const char *glass : {"BK7", "BAF10", "FK51A", "LASF9", "F5", "F10", "F11"})
        names.push_back(std::string("glass-") + glass);
    for (const char *metal : {"Ag", "Al", "Au", "Cu", "CuZn", "MgO", "TiO2"})
        for (const char *part : {"-eta", "-k"}) names.push_back(std::string("metal-") + metal + part);
    EXPECT_EQ(CameraSensorNames().size(), 17u);
    for (const std::string &sensor : CameraSensorNames())
        for (const char *channel : {"_r", "_g", "_b"}) names.push_back(sensor + channel);
    std::vector<std::string> have = NamedSpectrumNames();
    for (const std::string &name : names) {
        EXPECT_TRUE(NamedSpectrum(name)) << name;
        EXPECT_TRUE(std::count(have.begin(), have.end(), name)) << name;
    }
    EXPECT_EQ(have.size(), names.size());
    EXPECT_FALSE(NamedSpectrum("glass-BK8"));
}

TEST(NamedSpectra, KnownRefractiveIndices) {
    EXPECT_NEAR((*NamedSpectrum("glass-BK7"))(587.6f), 1.5168f, 1e-3);
    EXPECT_NEAR((*NamedSpectrum("metal-Au-eta"))(700), 0.13f, 0.04);
    EXPECT_GT((*NamedSpectrum("metal-Ag-k"))(600), 3.0f);
}

TEST(NamedSpectra, ShortTablesContinueWithTheirEndValues) {
    SpectrumPtr f1 = NamedSpectrum("stdillum-F1"), mgo = NamedSpectrum("metal-MgO-eta");
    EXPECT_GT((*f1)(360), 0.0f);
    EXPECT_FLOAT_EQ((*f1)(360), (*f1)(380));
    EXPECT_FLOAT_EQ((*f1)(830), (*f1)(780));
    EXPECT_FLOAT_EQ((*mgo)(830), 1.72872f);
    EXPECT_EQ((*f1)(358), 0.0f);
}

TEST(DenseSpectrum, TakesTheNearestNanometre) {
    std::vector<Float> values(471);
    for (size_t i = 0; i < values.size(); ++i) values[i] = Float(i + 1);
    DenseSpectrum s(values);
    EXPECT_EQ(s(360), 1.0f);
    EXPECT_EQ(s(360.49f), 1.0f);
    EXPECT_EQ(s(360.51f), 2.0f);
    EXPECT_EQ(s(830), 471.0f);
    EXPECT_EQ(s(359), 0.0f);
    EXPECT_EQ(s(831), 0.0f);
    EXPECT_EQ(s(-5), 0.0f);
    EXPECT_EQ(s.MaxValue(), 471.0f);
}

TEST(PiecewiseLinearSpectrum, AgreesWithPlainSearch) {
    Rng rng(11);
    for (int round = 0; round < 20; ++round) {
        std::vector<Float> lambdas, values;
        Float lambda = 200 + 250 * rng.Uniform();
        auto n = 1 + rng.UniformInt(60);
        for (uint32_t i = 0; i < n; ++i) {
            lambdas.push_back(lambda);
            values.push_back(rng.Uniform());
            lambda += Float(0.1) + 30 * rng.Uniform() * rng.Uniform();
        }
        PiecewiseLinearSpectrum s(lambdas, values);
        for (int i = 0; i < 2000; ++i) {
            Float l = 150 + 900 * rng.Uniform();
            if (i < int(n)) l = lambdas[size_t(i)];
            double wanted = 0;
            for (size_t k = 0; k + 1 < lambdas.size(); ++k)
                if (l >= lambdas[k] && l < lambdas[k + 1]) {
                    double t = (double(l) - double(lambdas[k])) / (double(lambdas[k + 1]) - double(lambdas[k]));
                    wanted = double(values[k]) * (1 - t) + double(values[k + 1]) * t;
                }
            if (l == lambdas.back()) wanted = double(values.back());
            ASSERT_NEAR(s(l), wanted, 1e-3) << l;
        }
        EXPECT_EQ(s(lambdas.front() - 1), 0.0f);
        EXPECT_EQ(s(lambdas.back() + 1), 0.0f);
        EXPECT_EQ(s.MaxValue(), *std::max_element(values.begin(), values.end()));
    }
}

TEST(Spectrum, SampleEqualsPointEvaluation) {
    PiecewiseLinearSpectrum linear({400, 500, 700}, {1, 3, 2});
    DenseSpectrum dense(linear);
    BlackbodySpectrum blackbody(4000);
    for (const Spectrum *s : {static_cast<const Spectrum *>(&linear), static_cast<const Spectrum *>(&dense),
                              static_cast<const Spectrum *>(&blackbody)})
        for (int i = 0; i < 50; ++i) {
            SampledWavelengths lambda = SampledWavelengths::SampleVisible(Float(i) / 50);
            SampledSpectrum v = s->Sample(lambda);
            for (int k = 0; k < SpectrumSamples; ++k) EXPECT_EQ(v[k], (*s)(lambda[k]));
        }
}

TEST(Blackbody, PeakIsOneAtWiensWavelength) {
    for (Float kelvin : {Float(3500), Float(4500), Float(6500), Float(8000)}) {
        BlackbodySpectrum s(kelvin);
        Float peak = 2.8977721e6f / kelvin;
        EXPECT_NEAR(s(peak), 1, 1e-5);
        EXPECT_LT(s(peak * 0.97f), 1.0f);
        EXPECT_LT(s(peak * 1.03f), 1.0f);
    }
}

TEST(Blackbody, IntegralIsStefanBoltzmann) {
    double sum = 0;
    for (double lambda = 50; lambda < 100000; lambda *= 1.001)
        sum += double(Blackbody(Float(lambda * 1.0005), 5000)) * lambda * 0.001 * 1e-9;
    double wanted = 5.670374e-8 * std::pow(5000.0, 4) / 3.14159265358979;
    EXPECT_NEAR(sum / wanted, 1, 2e-3);
    EXPECT_EQ(Blackbody(500, 0), 0.0f);
    EXPECT_EQ(Blackbody(400, 100), 0.0f);  // the exact value is too small for a float, and must not become NaN
}

TEST(SampledSpectrum, SafeDivideSkipsZeros) {
    SampledSpectrum a(6), b(2);
    b[2] = 0;
    SampledSpectrum q = SafeDivide(a, b);
    EXPECT_EQ(q[0], 3.0f);
    EXPECT_EQ(q[2], 0.0f);
}

}  // namespace
}  // namespace pbrt
