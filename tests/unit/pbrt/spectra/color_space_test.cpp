#include "pbrt/spectra/color_space.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#ifdef __SSE__
#include <xmmintrin.h>
#endif

#include <functional>
#include <limits>
#include <tuple>

#include "pbrt/math/rng.h"
#include "pbrt/spectra/rgb_primaries.h"

namespace pbrt {
namespace {

/// The RGB colour of a reflectance under the illuminant, integrated directly.
Rgb ReflectedRgb(const ColorSpace &space, const Spectrum &reflectance) {
    glm::dvec3 xyz(0);
    for (Float lambda = LambdaMin; lambda <= LambdaMax; ++lambda) {
        double v = double(reflectance(lambda)) * double(space.Illuminant()(lambda));
        xyz += v * glm::dvec3(CieX()(lambda), CieY()(lambda), CieZ()(lambda));
    }
    return space.ToRgb(Xyz(xyz / double(CieYIntegral)));
}

TEST(ColorSpace, FindIgnoresCase) {
    EXPECT_EQ(ColorSpace::Find("sRGB"), &ColorSpace::SRGB());
    EXPECT_EQ(ColorSpace::Find("Rec2020")->Name(), "rec2020");
    EXPECT_EQ(ColorSpace::Find("cmyk"), nullptr);
    EXPECT_EQ(ColorSpace::Find("srg"), nullptr);
    EXPECT_EQ(ColorSpace::Names(), (std::vector<std::string>{"srgb", "dci-p3", "rec2020", "aces2065-1"}));
}

TEST(ColorSpace, WhiteIsOneOneOneAndPrimariesAreUnitVectors) {
    for (const std::string &name : ColorSpace::Names()) {
        const ColorSpace &space = *ColorSpace::Find(name);
        Rgb white = space.ToRgb(SpectrumToXyz(space.Illuminant()));
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(white[c], 1, 1e-5) << name;
        Point2 wanted[3] = {space.R(), space.G(), space.B()};
        for (int c = 0; c < 3; ++c) {
            Rgb unit(0);
            unit[c] = 1;
            Point2 xy = Chromaticity(space.ToXyz(unit));
            EXPECT_NEAR(xy.x, wanted[c].x, 1e-5) << name;
            EXPECT_NEAR(xy.y, wanted[c].y, 1e-5) << name;
        }
        EXPECT_NEAR(Dot(space.Luminance(), Vector3(1)), 1, 1e-5) << name;
    }
}

TEST(ColorSpace, SrgbMatrixIsTheStandardOne) {
    const glm::mat3 &m = ColorSpace::SRGB().XyzFromRgb();
    EXPECT_NEAR(m[0].x, 0.4124, 3e-4);
    EXPECT_NEAR(m[1].y, 0.7152, 3e-4);
    EXPECT_NEAR(m[2].z, 0.9505, 3e-4);
    EXPECT_NEAR(m[2].y, 0.0722, 3e-4);
}

TEST(ColorSpace, WhiteOfRec2020IsThatOfStocksFiles) {
    EXPECT_NEAR(ColorSpace::Find("rec2020")->White().x, 0.312727f, 2e-6);
    EXPECT_NEAR(ColorSpace::Find("rec2020")->White().y, 0.329023f, 2e-6);
}

TEST(ColorSpace, ChromaticitiesIdentifyTheirSpace) {
    for (const std::string &name : ColorSpace::Names()) {
        const ColorSpace &s = *ColorSpace::Find(name);
        EXPECT_EQ(ColorSpace::FromChromaticities(s.R(), s.G() * Float(1.0005), s.B(), s.White()), &s);
        EXPECT_EQ(ColorSpace::FromChromaticities(s.R(), s.G(), s.B() + Point2(0.01f, 0), s.White()), nullptr);
    }
}

TEST(ColorSpace, ConvertMatrixRoundTrips) {
    const ColorSpace &a = ColorSpace::SRGB(), &b = *ColorSpace::Find("aces2065-1");
    Rgb c(0.2f, 0.5f, 0.7f), back = ConvertRgbMatrix(b, a) * (ConvertRgbMatrix(a, b) * c);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(back[i], c[i], 1e-5);
}

TEST(SigmoidPolynomial, GreysAreFlatAndExact) {
    const ColorSpace &space = ColorSpace::SRGB();
    for (int i = 0; i <= 100; ++i) {
        Float g = Float(i) / 100;
        SigmoidPolynomial p = space.ToPolynomial(Rgb(g));
        for (Float lambda : {Float(360), Float(555.5), Float(830)}) EXPECT_NEAR(p(lambda), g, 2e-6) << g;
        EXPECT_NEAR(p.MaxValue(), g, 2e-6);
    }
}

struct Errors {
    double worst = 0, mean = 0;
};
/// Of random colours of [0, brightest]^3 whose distance from grey was multiplied by `saturation`.
Errors RoundTripErrors(const ColorSpace &space, Float brightest, Float saturation) {
    Rng rng(5);
    constexpr int kColors = 2000;
    Errors errors;
    for (int i = 0; i < kColors; ++i) {
        Rgb rgb(rng.Uniform(), rng.Uniform(), rng.Uniform());
        rgb = brightest * Lerp(saturation, Rgb((rgb.x + rgb.y + rgb.z) / 3), rgb);
        Rgb back = ReflectedRgb(space, RgbAlbedoSpectrum(space, rgb));
        for (int c = 0; c < 3; ++c) {
            double error = std::abs(double(back[c]) - double(rgb[c]));
            errors.worst = std::max(errors.worst, error);
            errors.mean += error / (3 * kColors);
        }
    }
    return errors;
}

// Wider spaces hold colours that no reflectance has, so the colours keep further from their edge. The remaining error
// is that of interpolation and of the 5 nm quadrature of the fit, both chosen as in stock pbrt-v4.
TEST(SigmoidPolynomial, ColorsRoundTrip) {
    for (const auto &[name, moderate, saturated] : {std::tuple("srgb", 0.4f, 0.9f),
                                                    {"dci-p3", 0.4f, 0.65f},
                                                    {"rec2020", 0.4f, 0.65f},
                                                    {"aces2065-1", 0.25f, 0.4f}}) {
        const ColorSpace &space = *ColorSpace::Find(name);
        // Away from white, where the coefficients grow without bound and interpolation errs more.
        EXPECT_LT(RoundTripErrors(space, 0.85f, moderate).worst, 1e-3) << name;
        const Errors errors = RoundTripErrors(space, 1, saturated);
        EXPECT_LT(errors.worst, 5e-3) << name;
        EXPECT_LT(errors.mean, 4e-4) << name;
    }
}

TEST(SigmoidPolynomial, TablesHoldFiniteCoefficientsOnly) {
    Rng rng(9);
    for (const std::string &name : ColorSpace::Names())
        for (int i = 0; i < 20000; ++i) {
            Rgb rgb(rng.Uniform(), rng.Uniform(), rng.Uniform());
            if (i % 3 == 0) rgb[i / 3 % 3] = 0;
            if (i % 5 == 0) rgb *= 1e-4f;
            if (i % 7 == 0) rgb[i / 7 % 3] = 1;
            SigmoidPolynomial p = ColorSpace::Find(name)->ToPolynomial(rgb);
            ASSERT_TRUE(std::isfinite(p.c0 + p.c1 + p.c2)) << name << rgb.x << " " << rgb.y << " " << rgb.z;
        }
}

TEST(SigmoidPolynomial, IsContinuousAcrossSlabsAndCells) {
    // A walk through the cube in tiny steps, which crosses every kind of cell border; the spectrum must not jump.
    const ColorSpace &space = ColorSpace::SRGB();
    Float before = -1;
    for (int i = 0; i <= 20000; ++i) {
        Float t = Float(i) / 20000;
        Rgb rgb(Float(0.15) + Float(0.7) * t, Float(0.8) - Float(0.6) * t, Float(0.5) + Float(0.3) * std::sin(7 * t));
        Float value = space.ToPolynomial(rgb)(560);
        if (before >= 0) {
            ASSERT_LT(std::abs(value - before), 2e-3f) << t;
        }
        before = value;
    }
}

TEST(SigmoidPolynomial, MaxValueIsAtTheVertexOnlyIfThatIsAMaximumInside) {
    const Float middle = 600;
    auto parabola = [](Float curvature, Float vertex, Float value) {
        return SigmoidPolynomial{curvature, -2 * curvature * vertex, curvature * vertex * vertex + value};
    };
    EXPECT_NEAR(parabola(-1e-4f, middle, 0.7f).MaxValue(), parabola(0, 0, 0.7f)(middle), 1e-4f);
    for (const SigmoidPolynomial &s : {parabola(1e-4f, middle, -0.7f), parabola(-1e-4f, 300, 0.7f),
                                       parabola(-1e-4f, 900, 0.7f), SigmoidPolynomial{0, 0.01f, -6}})
        EXPECT_EQ(s.MaxValue(), std::max(s(LambdaMin), s(LambdaMax)));
    EXPECT_LT(parabola(-1e-4f, 900, 0.7f).MaxValue(), parabola(0, 0, 0.7f)(middle));
}

TEST(SigmoidPolynomial, MaxValueBoundsAllAndSampleAgrees) {
    Rng rng(2);
    for (int i = 0; i < 500; ++i) {
        RgbAlbedoSpectrum s(ColorSpace::SRGB(), {rng.Uniform(), rng.Uniform(), rng.Uniform()});
        Float seen = 0;
        for (Float lambda = LambdaMin; lambda <= LambdaMax; ++lambda) seen = std::max(seen, s(lambda));
        // Large terms of the quadratic cancel, so results of compilers that round differently differ by up to 1e-5.
        EXPECT_LE(seen, s.MaxValue() + 1e-4f);
        EXPECT_NEAR(seen, s.MaxValue(), 0.02);
        SampledWavelengths lambda = SampledWavelengths::SampleVisible(rng.Uniform());
        SampledSpectrum v = s.Sample(lambda);
        for (int k = 0; k < SpectrumSamples; ++k) EXPECT_NEAR(v[k], s(lambda[k]), 1e-4f);
    }
}

TEST(RgbSpectra, UnboundedAndIlluminantReproduceBrightColors) {
    const ColorSpace &space = ColorSpace::SRGB();
    Rgb rgb(3.4f, 2.4f, 1.2f);
    Rgb back = ReflectedRgb(space, RgbUnboundedSpectrum(space, rgb));
    Rgb emitted = space.ToRgb(SpectrumToXyz(RgbIlluminantSpectrum(space, rgb)));
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(back[c], rgb[c], 5e-3);
        EXPECT_NEAR(emitted[c], rgb[c], 5e-3);
    }
    EXPECT_EQ(RgbUnboundedSpectrum(space, Rgb(0))(500), 0.0f);
    EXPECT_EQ(RgbIlluminantSpectrum(space, Rgb(0))(500), 0.0f);
}

// All kinds of float components: zeros, denormal numbers, the ends of the normal range, the bounds and beyond, infinity
// and NaN.
const Float kExtremes[] = {0.0f,    -0.0f,   1e-45f, 1e-40f,   1e-38f,    1.18e-38f,
                           1e-37f,  1e-36f,  1e-20f, 1e-7f,    0.3f,      0.9999999f,
                           1.0f,    1.0001f, 250.0f, 1e20f,    9.9e36f,   3.4e38f,
                           -1e-40f, -0.5f,   -3e38f, Infinity, -Infinity, std::numeric_limits<Float>::quiet_NaN()};

/// Calls `check` for all triples of kExtremes in every space.
void ForExtremeColors(const std::function<void(const ColorSpace &, const Rgb &)> &check) {
    for (const std::string &name : ColorSpace::Names())
        for (Float r : kExtremes)
            for (Float g : kExtremes)
                for (Float b : kExtremes) check(*ColorSpace::Find(name), {r, g, b});
}

void ExpectDefined(const Spectrum &s, Float bound, const ColorSpace &space, const Rgb &rgb) {
    const Float max = s.MaxValue();
    auto where = [&] { return fmt::format("{} {} {} {}", space.Name(), rgb.x, rgb.y, rgb.z); };
    ASSERT_TRUE(max >= 0 && max <= bound) << where() << ": " << max;
    for (Float lambda : {LambdaMin, Float(441), Float(555), Float(623), LambdaMax}) {
        const Float value = s(lambda);
        ASSERT_TRUE(value >= 0 && value <= max * Float(1.0001) + Float(1e-4) * bound) << where() << ": " << value;
    }
}

TEST(RgbSpectra, AreDefinedForEveryRgb) {
    ForExtremeColors([](const ColorSpace &space, const Rgb &rgb) {
        const Float largest = std::max({Float(0), rgb.x, rgb.y, rgb.z});
        const Float bright = std::min(largest, Float(1e37));
        ExpectDefined(RgbAlbedoSpectrum(space, rgb), 1, space, rgb);
        ExpectDefined(RgbUnboundedSpectrum(space, rgb), 2 * bright, space, rgb);
        ExpectDefined(RgbIlluminantSpectrum(space, rgb), 2 * bright * space.Illuminant().MaxValue(), space, rgb);
        // Components that count as 0 or lie beyond the bounds give the same spectrum as 0 and the bound.
        auto counted = [](Float v, Float bound) { return v > 0 ? std::min(v, bound) : Float(0); };
        auto all = [&](Float bound) {
            return Rgb(counted(rgb.x, bound), counted(rgb.y, bound), counted(rgb.z, bound));
        };
        ASSERT_EQ(RgbAlbedoSpectrum(space, rgb)(500), RgbAlbedoSpectrum(space, all(1))(500));
        ASSERT_EQ(RgbUnboundedSpectrum(space, rgb)(500), RgbUnboundedSpectrum(space, all(1e37f))(500));
        ASSERT_EQ(RgbIlluminantSpectrum(space, rgb)(500), RgbIlluminantSpectrum(space, all(1e37f))(500));
    });
}

TEST(RgbSpectra, AreDefinedWhereDenormalNumbersCountAsZero) {
#ifdef __SSE__
    const unsigned before = _mm_getcsr();
    _mm_setcsr(before | 0x8040);  // flush denormal results to zero, and read denormal operands as zero
    ForExtremeColors([](const ColorSpace &space, const Rgb &rgb) {
        for (Float lambda : {Float(441), Float(623)}) {
            ASSERT_TRUE(std::isfinite(RgbAlbedoSpectrum(space, rgb)(lambda)));
            ASSERT_TRUE(std::isfinite(RgbUnboundedSpectrum(space, rgb)(lambda)));
            ASSERT_TRUE(std::isfinite(RgbIlluminantSpectrum(space, rgb)(lambda)));
        }
    });
    _mm_setcsr(before);
#else
    GTEST_SKIP() << "NOT TESTED: this processor has no mode in which denormal numbers count as zero";
#endif
}

TEST(RgbSpectra, TinyReflectancesAreBlack) {
    // The result is as black as the darkest node of the fitted tables. In wider spaces the darkest pure colours have no
    // fit.
    const ColorSpace &space = ColorSpace::SRGB();
    for (Float tiny : {1e-45f, 1e-40f, 1e-38f, 1e-37f, 1e-36f, 1e-20f})
        for (const Rgb &rgb : {Rgb(tiny, 0, 0), Rgb(0, tiny, 0), Rgb(0, 0, tiny), Rgb(tiny, tiny, 0), Rgb(tiny)}) {
            const Rgb seen = glm::abs(ReflectedRgb(space, RgbAlbedoSpectrum(space, rgb)));
            EXPECT_LT(std::max({seen.x, seen.y, seen.z}), 5e-3) << tiny;
        }
}

TEST(RgbSpectra, UnboundedAndIlluminantScaleWithTheirColor) {
    for (const std::string &name : ColorSpace::Names()) {
        const ColorSpace &space = *ColorSpace::Find(name);
        const Rgb rgb(0.4f, 0.7f, 0.1f);
        for (Float factor : {1e-36f, 1e-20f, 1e-3f, 1e3f, 1e20f, 1e37f})
            for (Float lambda : {Float(441), Float(555), Float(623)}) {
                EXPECT_NEAR(RgbUnboundedSpectrum(space, factor * rgb)(lambda) / factor,
                            RgbUnboundedSpectrum(space, rgb)(lambda), 1e-4f);
                EXPECT_NEAR(RgbIlluminantSpectrum(space, factor * rgb)(lambda) / factor,
                            RgbIlluminantSpectrum(space, rgb)(lambda), 1e-4f);
            }
    }
}

TEST(SpectrumToPhotometric, CountsTheIlluminantOnly) {
    const ColorSpace &space = ColorSpace::SRGB();
    Float one = SpectrumToPhotometric(RgbIlluminantSpectrum(space, {0.2f, 0.1f, 0.7f}));
    EXPECT_NEAR(one, CieYIntegral, 1e-2);
    EXPECT_EQ(one, SpectrumToPhotometric(RgbIlluminantSpectrum(space, {5, 5, 5})));
    EXPECT_NEAR(SpectrumToPhotometric(ConstantSpectrum(2)), 2 * CieYIntegral, 1e-2);
    EXPECT_NEAR(SpectrumToPhotometric(*NamedSpectrum("stdillum-A")), CieYIntegral, 1e-2);
}

TEST(WhiteBalance, MapsWhiteToWhiteAndIsItsOwnInverse) {
    Point2 a(0.44757f, 0.40745f), d65(0.31272f, 0.32903f);
    Xyz mapped = WhiteBalanceMatrix(a, d65) * XyzFromChromaticity(a), wanted = XyzFromChromaticity(d65);
    glm::mat3 identity = WhiteBalanceMatrix(d65, a) * WhiteBalanceMatrix(a, d65);
    for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(mapped[i], wanted[i], 1e-5);
        for (int j = 0; j < 3; ++j) EXPECT_NEAR(identity[i][j], i == j ? 1 : 0, 1e-5);
    }
    // The published Bradford matrix D65 -> D50 (Lindbloom), transposed into columns.
    glm::mat3 m = WhiteBalanceMatrix({0.312727f, 0.329023f}, {0.345669f, 0.358496f});
    EXPECT_NEAR(m[0][0], 1.0478f, 1e-3);
    EXPECT_NEAR(m[1][0], 0.0229f, 1e-3);
    EXPECT_NEAR(m[2][2], 0.7521f, 1e-3);
}

TEST(Daylight, HasTheChromaticitiesOfTheCieIlluminants) {
    struct Row {
        Float kelvin, x, y;
    };
    for (const Row &row : {Row{5000, 0.34567f, 0.35850f},
                           {5500, 0.33242f, 0.34743f},
                           {6500, 0.31272f, 0.32903f},
                           {7500, 0.29902f, 0.31485f}}) {
        Vector3 xyz = SpectrumToXyz(DaylightSpectrum(row.kelvin));
        EXPECT_NEAR(xyz.y, 1, 1e-5);
        EXPECT_NEAR(Chromaticity(xyz).x, row.x, 3e-4) << row.kelvin;
        EXPECT_NEAR(Chromaticity(xyz).y, row.y, 3e-4) << row.kelvin;
    }
    // Below 4000 K the spectrum is that of a black body: the Planckian locus at 2856 K (illuminant A).
    Vector3 a = SpectrumToXyz(DaylightSpectrum(2856));
    EXPECT_NEAR(Chromaticity(a).x, 0.4476f, 1e-3);
    EXPECT_NEAR(Chromaticity(a).y, 0.4074f, 1e-3);
}

}  // namespace
}  // namespace pbrt
