#include "pbrt/textures/noise.h"

#include <gtest/gtest.h>

#include "support/sampling.h"
#include "texture_test_support.h"

namespace pbrt::test {
namespace {

TextureContext At(const Point3 &p, Float step = 0) {
    TextureContext ctx;
    ctx.p = p;
    ctx.uv = {p.x, p.y};
    ctx.dpdx = {step, 0, 0};
    ctx.dpdy = {0, step / 2, 0};
    return ctx;
}

TEST(Noise, VanishesAtLatticePointsAndRepeats) {
    Rng rng(5);
    for (int i = 0; i < 200; ++i) {
        EXPECT_EQ(GradientNoise(glm::floor(Float(400) * RandomVector(rng))), 0.0f);
        Point3 p = glm::floor(Float(20 * 64) * RandomVector(rng)) / Float(64);
        EXPECT_EQ(GradientNoise(p), GradientNoise(p + Point3(256, -256, 512)));
    }
}

TEST(Noise, IsBoundedWithMeanZeroAndIsNotSmall) {
    Rng rng(7);
    double sum = 0, squares = 0, magnitude = 0;
    constexpr int kDraws = 200000;
    for (int i = 0; i < kDraws; ++i) {
        double n = double(GradientNoise(Float(128) * RandomVector(rng)));
        ASSERT_LE(std::abs(n), 1.04);
        sum += n;
        squares += n * n;
        magnitude += std::abs(n);
    }
    EXPECT_NEAR(sum / kDraws, 0, 5e-3);
    EXPECT_NEAR(std::sqrt(squares / kDraws), 0.25, 0.05);
    EXPECT_NEAR(magnitude / kDraws, 0.2, 0.03);  // "wrinkled" uses this mean for octaves that are filtered away
}

TEST(Noise, IsSmoothAcrossCells) {
    // Values and slopes on both sides of a face between cells must agree.
    Rng rng(11);
    constexpr Float h = 1e-3f;
    for (int i = 0; i < 300; ++i) {
        Point3 p = Float(30) * RandomVector(rng);
        int axis = i % 3;
        p[axis] = std::floor(p[axis]);
        Point3 left = p, right = p;
        left[axis] -= h;
        right[axis] += h;
        Float middle = GradientNoise(p);
        EXPECT_NEAR(middle - GradientNoise(left), GradientNoise(right) - middle, 2e-4f);
    }
}

TEST(Noise, SlopeIsTheLimitOfDifferences) {
    Rng rng(13);
    constexpr Float h = 1e-3f;
    for (int i = 0; i < 500; ++i) {
        const Point3 p = i % 5 ? Float(8) * RandomVector(rng) : glm::floor(Float(8) * RandomVector(rng));
        const Vector3 slope = GradientNoiseSlope(p);
        for (int axis = 0; axis < 3; ++axis) {
            Point3 low = p, high = p;
            low[axis] -= h;
            high[axis] += h;
            EXPECT_NEAR(slope[axis], (GradientNoise(high) - GradientNoise(low)) / (high[axis] - low[axis]), 3e-3f);
        }
    }
}

TEST(Noise, SlopeAtALatticePointIsOneOfTheEdgeDirections) {
    constexpr Float h = 1e-2f;
    for (int z = 0; z < 8; ++z)
        for (int x = 0; x < 8; ++x) {
            const Point3 p(Float(x), 3, Float(z));
            int zeros = 0, ones = 0;
            for (int axis = 0; axis < 3; ++axis) {
                Point3 o(0);
                o[axis] = h;
                Float slope = (GradientNoise(p + o) - GradientNoise(p - o)) / (2 * h);
                zeros += std::abs(slope) < 0.02f;
                ones += std::abs(std::abs(slope) - 1) < 0.02f;
            }
            EXPECT_EQ(zeros, 1);
            EXPECT_EQ(ones, 2);
        }
}

TEST(Noise, OctavesAddUp) {
    const NoiseOctaves octaves{0.6f, 4};
    Rng rng(13);
    for (int i = 0; i < 50; ++i) {
        const Point3 p = Float(4) * RandomVector(rng);
        Float expected = 0, creased = 0;
        for (int k = 0; k < 4; ++k) {
            const Float n = GradientNoise(std::pow(1.99f, Float(k)) * p), w = std::pow(0.6f, Float(k));
            expected += w * n;
            creased += w * std::abs(n);
        }
        EXPECT_NEAR(octaves.Signed(p, Vector3(0), Vector3(0)), expected, 1e-4f);
        EXPECT_NEAR(octaves.Creased(p, Vector3(0), Vector3(0)), creased + 0.2f * std::pow(0.6f, 4.0f), 1e-4f);
    }
}

TEST(Noise, WideFootprintsLeaveTheMean) {
    const NoiseOctaves octaves{0.5f, 8};
    Rng rng(17);
    for (int i = 0; i < 20; ++i) {
        const Point3 p = Float(4) * RandomVector(rng);
        EXPECT_EQ(octaves.Signed(p, {2, 0, 0}, {0, 1, 0}), 0.0f);
        // Means of the first octave and of all of them.
        EXPECT_NEAR(octaves.Creased(p, {2, 0, 0}, {0, 1, 0}), 0.2f + 0.2f * (2 - std::pow(0.5f, 7.0f)), 1e-5f);
    }
}

TEST(Noise, FadesContinuouslyWithTheFootprint) {
    const NoiseOctaves octaves{0.8f, 6};
    const Point3 p(0.37f, 1.81f, -2.63f);
    Float previous = octaves.Signed(p, {0.001f, 0, 0}, Vector3(0));
    for (int i = 1; i < 4000; ++i) {
        const Float step = 0.001f * std::pow(1000.0f, Float(i) / 4000);
        const Float now = octaves.Signed(p, {step, 0, 0}, Vector3(0));
        ASSERT_NEAR(now, previous, 0.02f) << step;
        previous = now;
    }
}

TEST(NoiseTextures, WorkInTextureSpace) {
    Bench b;
    const Transform grow = Transform::Scale({0.25f, 0.25f, 0.25f});
    b.Define("f", false, "fbm", Params().Integer("octaves", 3).Number("roughness", 0.7f), grow);
    b.Define("w", false, "wrinkled", Params(), grow);
    b.Define("d", false, "windy", Params(), grow);
    const Point3 p(0.3f, 0.8f, -0.45f);
    const Vector3 dx(0.02f, 0, 0), dy(0, 0.01f, 0);
    const TextureContext ctx = At(p, 0.02f);
    EXPECT_FLOAT_EQ(b.FloatTex("f")->Evaluate(ctx), (NoiseOctaves{0.7f, 3}.Signed(4.0f * p, 4.0f * dx, 4.0f * dy)));
    EXPECT_FLOAT_EQ(b.FloatTex("w")->Evaluate(ctx), (NoiseOctaves{0.5f, 8}.Creased(4.0f * p, 4.0f * dx, 4.0f * dy)));
    const Float gust = NoiseOctaves{0.5f, 3}.Signed(0.4f * p, 0.4f * dx, 0.4f * dy);
    EXPECT_NEAR(b.FloatTex("d")->Evaluate(ctx),
                std::abs(gust) * (NoiseOctaves{0.5f, 6}.Signed(4.0f * p, 4.0f * dx, 4.0f * dy)), 1e-5f);
    EXPECT_EQ(b.Errors(), 0u);
}

TEST(NoiseTextures, MarbleVeinsRunAlongY) {
    Bench b;
    b.Define("m", true, "marble", Params().Number("variation", 0).Number("scale", 3));
    const SampledWavelengths lambda = SampledWavelengths::SampleVisible(0.4f);
    auto value = [&](Float x, Float y) { return b.SpectrumTex("m")->Evaluate(At({x, y, 0}), lambda); };
    Float low = 1, high = 0;
    for (int i = 0; i < 100; ++i) {
        const Float y = Float(i) / 30;
        for (int k = 0; k < SpectrumSamples; ++k) {
            EXPECT_EQ(value(0, y)[k], value(7, y)[k]);
            EXPECT_NEAR(value(0, y)[k], value(0, y + 2 * Pi / 3)[k], 2e-3f);
            low = std::min(low, value(0, y)[k]);
            high = std::max(high, value(0, y)[k]);
        }
    }
    EXPECT_LT(low, 0.65f);
    EXPECT_NEAR(high, 0.9f, 0.03f);
    // The dark vein is at 5/6 of the height of the wave; both ends have the bright colour 1.5 * (.58, .58, .6).
    const SampledSpectrum bright = RgbAlbedoSpectrum(ColorSpace::SRGB(), {.87f, .87f, .9f}).Sample(lambda);
    for (int k = 0; k < SpectrumSamples; ++k) EXPECT_NEAR(value(0, -Pi / 6)[k], bright[k], 1e-4f);
}

TEST(DotsTexture, InsideAndOutsideAreSwappedAsInStock) {
    Bench b;
    b.Define("d", false, "dots", Params().Number("inside", 5).Number("outside", 9));
    // There is never a dot in the corners between cells.
    for (int i = 0; i < 20; ++i) EXPECT_EQ(b.FloatTex("d")->Evaluate(At({Float(i) + 0.5f, 2.5f, 0})), 5);
}

TEST(DotsTexture, SomeCellsHoldOneDotOfRadius035) {
    Bench b;
    b.Define("d", false, "dots", Params().Number("inside", 0).Number("outside", 1));
    const FloatTexturePtr dots = b.FloatTex("d");
    Rng rng(19);
    int cells = 0, full = 0;
    for (int y = 0; y < 40; ++y)
        for (int x = 0; x < 40; ++x) {
            constexpr int kSide = 24;
            int inside = 0;
            for (int i = 0; i < kSide * kSide; ++i) {
                const Point2 o = (Point2(i % kSide, i / kSide) + Float(0.5)) / Float(kSide) - Float(0.5);
                inside += dots->Evaluate(At({Float(x) + o.x, Float(y) + o.y, 0})) == 1;
            }
            ++cells;
            full += inside > 0;
            if (inside > 0) {
                EXPECT_NEAR(double(inside) / (kSide * kSide), 3.14159265 * 0.35 * 0.35, 0.03);
            }
        }
    // The noise that decides is 0 in the middle of many cells.
    EXPECT_NEAR(double(full) / cells, 0.4, 0.1);
}

TEST(NoiseTextures, MistakesAreErrors) {
    Bench b;
    b.Define("f", false, "fbm", Params("Texture \"f\"", 10).Integer("octaves", -1));
    b.Define("flat", false, "windy", Params("Texture \"flat\"", 20), Transform::Scale({1, 0, 1}));
    b.textures.CheckAll();
    b.ExpectErrors({11, 20});
}

}  // namespace
}  // namespace pbrt::test
