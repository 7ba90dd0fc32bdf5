#include <gtest/gtest.h>

#include "media_test_support.h"
#include "pbrt/media/medium_kinds.h"
#include "pbrt/textures/noise.h"

namespace pbrt::test {
namespace {

TEST(Medium, MajorantsBoundTheCoefficientsEverywhere) {
    for (const Transform &place : Places())
        for (const NamedMedium &m : AllMedia(place)) {
            Rng rng(11);
            int places = 0;
            double tightest = 0;
            while (places < 25000) {
                const Point3 a = place.Point(PointNear(m.bounds, rng, 0.5f));
                const Point3 b = place.Point(PointNear(m.bounds, rng, 0.5f));
                MediumOnRay onRay = m.medium->On(RayThrough(a, b), 20, kLambda);
                MajorantSegment s;
                while (onRay.Next(&s)) {
                    ASSERT_GE(s.begin, 0);
                    ASSERT_LE(s.end, 20);
                    for (int i = 0; i < 8; ++i, ++places) {
                        const Float u = i == 0 ? 0 : i == 1 ? 1 : rng.Uniform();
                        const MediumCoefficients c = onRay.At(std::clamp(Lerp(u, s.begin, s.end), s.begin, s.end));
                        for (int k = 0; k < SpectrumSamples; ++k) {
                            ASSERT_LE(c.absorption[k] + c.scattering[k], s.majorant[k]) << m.name;
                            ASSERT_GE(c.absorption[k], 0) << m.name;
                            ASSERT_GE(c.scattering[k], 0) << m.name;
                            tightest = std::max(tightest, double((c.absorption[k] + c.scattering[k]) / s.majorant[k]));
                        }
                    }
                }
            }
            EXPECT_GT(tightest, 0.7) << m.name << ": the majorants are loose";
        }
}

TEST(Medium, NothingIsBetweenTheSegments) {
    for (const NamedMedium &m : AllMedia(Places()[1])) {
        Rng rng(12);
        for (int i = 0; i < 2000; ++i) {
            const Point3 a = m.place.Point(PointNear(m.bounds, rng, 0.5f));
            const Point3 b = m.place.Point(PointNear(m.bounds, rng, 0.5f));
            const Ray ray = RayThrough(a, b);
            MediumOnRay onRay = m.medium->On(ray, 20, kLambda);
            MajorantSegment s;
            Float last = 0;
            auto expectVacuum = [&](Float from, Float to) {
                for (int k = 1; k < 4; ++k) {
                    const MediumCoefficients c = m.medium->At(ray(Lerp(Float(k) / 4, from, to)), kLambda);
                    EXPECT_LT((c.absorption + c.scattering).MaxComponent(), 1e-4f) << m.name;
                }
            };
            while (onRay.Next(&s)) {
                if (s.begin > last) expectVacuum(last, s.begin);
                last = s.end;
            }
            if (last < 20) expectVacuum(last, 20);
        }
    }
}

TEST(Medium, OnRayAndAtAgree) {
    for (const Transform &place : Places())
        for (const NamedMedium &m : AllMedia(place)) {
            Rng rng(13);
            for (int i = 0; i < 500; ++i) {
                const Ray ray =
                    RayThrough(place.Point(PointNear(m.bounds, rng, 1)), place.Point(PointNear(m.bounds, rng)));
                MediumOnRay onRay = m.medium->On(ray, 10, kLambda);
                for (int k = 0; k < 4; ++k) {
                    const Float t = 10 * rng.Uniform();
                    const MediumCoefficients a = onRay.At(t), b = m.medium->At(ray(t), kLambda);
                    EXPECT_LT((a.absorption - b.absorption).Map([](Float v) { return std::abs(v); }).MaxComponent(),
                              2e-3f)
                        << m.name;
                }
            }
        }
}

TEST(Medium, CopiesOfAMediumOnARayAreIndependent) {
    for (const NamedMedium &m : AllMedia({})) {
        const MediumOnRay made = m.medium->On(RayThrough({-2, 0.3f, 0.4f}, {2, 0.35f, 0.45f}), 10, kLambda);
        MediumOnRay a = made, b = made;
        MajorantSegment s, t;
        while (a.Next(&s)) {
        }
        int count = 0;
        while (b.Next(&t)) {
            ++count;
            EXPECT_TRUE(std::isfinite(b.At(t.begin).absorption[0]));
        }
        EXPECT_GT(count, 0) << m.name;
    }
}

/// Linear interpolation between voxel centres in double precision, 0 outside.
double Trilinear(const std::vector<Float> &values, const glm::ivec3 &n, const glm::dvec3 &unit) {
    const glm::dvec3 v = unit * glm::dvec3(n) - 0.5, low = glm::floor(v), w = v - low;
    double sum = 0;
    for (int i = 0; i < 8; ++i) {
        const glm::ivec3 at = glm::ivec3(low) + glm::ivec3(i & 1, (i >> 1) & 1, i >> 2);
        if (at.x < 0 || at.y < 0 || at.z < 0 || at.x >= n.x || at.y >= n.y || at.z >= n.z) continue;
        sum += double(values[size_t((at.z * n.y + at.y) * n.x + at.x)]) * (i & 1 ? w.x : 1 - w.x) *
               (i & 2 ? w.y : 1 - w.y) * (i & 4 ? w.z : 1 - w.z);
    }
    return sum;
}

TEST(UniformGridMedium, DensityIsInterpolatedInItsOwnSpace) {
    const glm::ivec3 n(9, 5, 21);
    for (const Transform &place : Places()) {
        std::vector<Float> values;
        const NamedMedium m = MakeSparseGrid(place, &values);
        Rng rng(4);
        const RgbUnboundedSpectrum absorption(ColorSpace::SRGB(), {0.5f, 1, 1.5f}),
            scattering(ColorSpace::SRGB(), {2, 1, 0});
        for (int i = 0; i < 2000; ++i) {
            const Point3 own = PointNear(m.bounds, rng, 0.1f);
            const MediumCoefficients c = m.medium->At(place.Point(own), kLambda);
            const Vector3 unit = (own - m.bounds.low) / m.bounds.Diagonal();
            const bool isInside = m.bounds.Contains(own);
            const double density = isInside ? Trilinear(values, n, unit) : 0;
            for (int k = 0; k < SpectrumSamples; ++k) {
                const Float nm = std::round(kLambda[k]);
                EXPECT_NEAR(c.absorption[k], density * double(absorption(nm)), 2e-4);
                EXPECT_NEAR(c.scattering[k], density * double(scattering(nm)), 2e-4);
            }
        }
    }
}

TEST(RgbGridMedium, VoxelsAreSpectra) {
    Params p = CountOf({2, 1, 1});
    p.Floats(ParamType::Rgb, "sigma_a", {0.2f, 0.4f, 3, 1, 2, 0}).Number("scale", 2);
    const auto medium = MakeMedium("rgbgrid", p);
    const RgbUnboundedSpectrum first(ColorSpace::SRGB(), {0.2f, 0.4f, 3}), second(ColorSpace::SRGB(), {1, 2, 0});
    const SampledSpectrum a = first.Sample(kLambda), b = second.Sample(kLambda);
    auto expect = [&](Float x, Float wa, Float wb) {
        const MediumCoefficients c = medium->At({x, 0.5f, 0.5f}, kLambda);
        for (int k = 0; k < SpectrumSamples; ++k) {
            EXPECT_NEAR(c.absorption[k], 2 * (wa * a[k] + wb * b[k]), 1e-4f) << x;
            EXPECT_EQ(c.scattering[k], 2) << x;  // not given: 1, times the scale
        }
    };
    expect(0.25f, 1, 0);
    expect(0.75f, 0, 1);
    expect(0.4f, 0.7f, 0.3f);
    expect(0.125f, 0.75f, 0);  // fades outside the outermost centres
    EXPECT_FALSE(medium->At({1.01f, 0.5f, 0.5f}, kLambda).absorption);
}

TEST(CloudMedium, DensityIsItsFormulaThoughOctavesThatCannotMatterAreLeftOut) {
    Rng rng(7);
    int empty = 0, full = 0;
    for (const CloudMedium::Shape shape : {CloudMedium::Shape{1, 1, 5}, {0.3f, 0, 20}, {4, 0.5f, 3}, {0, 1, 5}})
        for (int i = 0; i < 20000; ++i) {
            const Point3 p = PointNear({{0, -0.2f, 0}, {3, 1.4f, 3}}, rng);
            Point3 at = shape.frequency * p;
            Float strength = 0.05f * shape.wispiness, fineness = 10;
            for (int octave = 0; octave < 2; ++octave) {
                at += strength * GradientNoiseSlope(fineness * at);
                strength /= 2;
                fineness *= 1.99f;
            }
            Float noise = 0;
            strength = fineness = 1;
            for (int octave = 0; octave < 5; ++octave) {
                noise += (strength /= 2) * GradientNoise(fineness * at);
                fineness *= 1.99f;
            }
            const Float puffs = std::clamp((1 - p.y) * 4.5f * shape.density * noise, 0.f, 1.f);
            const Float all = std::clamp(puffs + 2 * std::max(0.f, 0.5f - p.y), 0.f, 1.f);
            ASSERT_NEAR(shape.DensityAt(p), all, 2e-6f) << p.x << " " << p.y << " " << p.z;
            empty += all == 0;
            full += all == 1;
        }
    EXPECT_GT(empty, 5000);
    EXPECT_GT(full, 5000);
}

TEST(HomogeneousMedium, PresetsAreTheTablesValues) {
    const auto medium = MakeMedium("homogeneous", Params().String("preset", "Skin1").Number("scale", 2));
    const SampledSpectrum a = RgbUnboundedSpectrum(ColorSpace::SRGB(), {0.032f, 0.17f, 0.48f}).Sample(kLambda),
                          s = RgbUnboundedSpectrum(ColorSpace::SRGB(), {0.74f, 0.88f, 1.01f}).Sample(kLambda);
    const MediumCoefficients c = medium->At({1e6f, 0, 0}, kLambda);
    for (int k = 0; k < SpectrumSamples; ++k) {
        EXPECT_NEAR(c.absorption[k], 2 * a[k], 5e-3f);
        EXPECT_NEAR(c.scattering[k], 2 * s[k], 5e-3f);
    }
    EXPECT_FALSE(medium->IsEmissive());
}

}  // namespace
}  // namespace pbrt::test
