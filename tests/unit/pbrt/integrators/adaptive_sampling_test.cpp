// Estimates of noise, and the images of adaptive renders.
#include "pbrt/integrators/adaptive_sampling.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pbrt/core/progress.h"
#include "pbrt/images/metrics.h"
#include "pbrt/integrators/pixel_integrator.h"
#include "pbrt/integrators/render_loop.h"
#include "pbrt/math/statistics.h"
#include "support/param.h"

namespace pbrt {
namespace {

TEST(AdaptiveSampleIndices, AreDistinctSetsOfBothStreams) {
    std::vector<int> even, odd;
    for (int sample = 0; sample < 12; ++sample) (sample % 2 ? odd : even).push_back(AdaptiveSampleIndex(sample, 4));
    EXPECT_EQ(even, (std::vector<int>{0, 1, 2, 3, 8, 9}));
    EXPECT_EQ(odd, (std::vector<int>{4, 5, 6, 7, 12, 13}));
}

enum class Noise { None, Everywhere, Right, Corner, RareRight, SmoothLeft };

/// Radiance 1 in the mean: 1 / p with a probability that is small where the noise is.
class Spikes final : public PixelIntegrator {
  public:
    explicit Spikes(int width, Noise noise) : width_(width), noise_(noise) {}
    SampledSpectrum Li(const PathStart &start, SampledWavelengths &, Sampler &sampler) const override {
        const Float p = Probability(start.pixel), u = sampler.Get1D();
        if (noise_ != Noise::SmoothLeft) return SampledSpectrum(u < p ? 1 / p : Float(0));
        // Smooth, but noisier than the right half as long as samples are few; the right half is not stratified.
        if (2 * start.pixel.x < width_) return SampledSpectrum(20 * std::pow(u, Float(19)));
        const Float hash = u * 65536 - std::floor(u * 65536);
        return SampledSpectrum(hash < Float(0.3) ? 1 / Float(0.3) : Float(0));
    }

  private:
    Float Probability(Point2i pixel) const {
        switch (noise_) {
            case Noise::Everywhere: return Float(0.3);
            case Noise::Right: return 4 * pixel.x < 3 * width_ ? Float(0.9) : Float(0.05);
            case Noise::RareRight: return 2 * pixel.x < width_ ? Float(1) : Float(0.001);
            case Noise::Corner: return std::max(pixel.x, pixel.y) < width_ / 4 ? Float(0.05) : Float(1);
            default: return 1;
        }
    }
    int width_;
    Noise noise_;
};

class AdaptiveRender : public ::testing::Test {
  protected:
    static constexpr int kWidth = 64, kHeight = 48;

    struct Result {
        Image image;
        RenderResult render;
    };
    static Result Render(bool isAdaptive, int samples, int seed, Noise place = Noise::Right, double noise = 0,
                         const char *samplerName = "independent") {
        DiagnosticSink sink;
        FilmContext context{.outputSpace = ColorSpace::SRGB()};
        context.overrides.fullFloat = true;
        ParamSet size("Film", {});
        size.Add(test::IntParam("xresolution", kWidth));
        size.Add(test::IntParam("yresolution", kHeight));
        const auto film = MakeFilm("rgb", size, context, sink), half = film->MakeRgbFilm();
        const auto filter = Filters().Make("box", ParamSet(), FilterContext{sink});
        const auto camera = Cameras().Make("orthographic", ParamSet(),
                                           CameraContext{AnimatedTransform(), {kWidth, kHeight}, 35, {}, sink});
        const int setSize = noise > 0 ? (samples + 1) / 2 : samples;
        const auto sampler =
            Samplers().Make(samplerName, ParamSet(), SamplerContext{{kWidth, kHeight}, setSize, seed, sink});
        Spikes integrator(kWidth, place);
        Progress progress;
        RenderSettings settings;
        settings.samplesPerPixel = samples;
        settings.disableWavelengthJitter = true;
        settings.noise = noise;
        const RenderResult result = RenderWaves(
            {integrator, *camera, *filter, *film, *sampler, progress, Team::Alone(), isAdaptive ? half.get() : nullptr},
            settings);
        return {film->ToImage(), result};
    }
    static const Image &Truth() {
        static const Image image = Render(false, 1, 0, Noise::None).image;
        return image;
    }
};

TEST_F(AdaptiveRender, SpendsItsSamplesWhereTheNoiseIs) {
    const Result adaptive = Render(true, 128, 1);
    ASSERT_TRUE(adaptive.render.adaptive);
    EXPECT_EQ(adaptive.render.samplesTaken, 128);
    EXPECT_NEAR(adaptive.render.adaptive->meanSamples, 128, 0.1);
    EXPECT_GT(adaptive.render.adaptive->maxSamples, 4 * adaptive.render.adaptive->minSamples);
    double errors[2] = {};
    for (int seed = 1; seed <= 8; ++seed)
        for (const bool isAdaptive : {false, true})
            errors[isAdaptive] += ImageError(Render(isAdaptive, 128, seed).image, Truth(), Metric::RelL2);
    EXPECT_GT(errors[0] / errors[1], 2);
}

TEST_F(AdaptiveRender, OfEqualNoiseIsTheUniformImage) {
    for (const char *sampler : {"zsobol", "independent"})
        for (const int samples : {37, 96})
            for (const Noise place : {Noise::Everywhere, Noise::None}) {
                const Result adaptive = Render(true, samples, 2, place, 0, sampler);
                const Image uniform = Render(false, samples, 2, place, 0, sampler).image;
                EXPECT_GT(adaptive.render.adaptive->decisions, 2);
                EXPECT_EQ(adaptive.render.adaptive->uniformDecisions, adaptive.render.adaptive->decisions);
                EXPECT_EQ(adaptive.render.adaptive->minSamples, samples);
                EXPECT_EQ(adaptive.render.adaptive->maxSamples, samples);
                EXPECT_LT(adaptive.render.adaptive->predictedGain, 1.15);
                // Other samplers would lose stratification.
                if (std::string_view(sampler) == "independent") {
                    EXPECT_GT(adaptive.render.adaptive->predictedGain, 0.85);
                }
                int different = 0;
                ForEachValue(uniform,
                             [&](Point2i p, int c) { different += uniform.Get(p, c) != adaptive.image.Get(p, c); });
                EXPECT_EQ(different, 0) << sampler << samples;
            }
}

TEST_F(AdaptiveRender, OfNoiseInACornerIsNotUniform) {
    const AdaptiveResult result = Render(true, 128, 2, Noise::Corner).render.adaptive.value();
    EXPECT_EQ(result.decisions, 4);
    EXPECT_EQ(result.uniformDecisions, 0);
    EXPECT_GT(result.predictedGain, SamplePlan::kMinGain);
    EXPECT_GT(result.maxSamples, 4 * result.minSamples);
}

/// Samplers whose first samples are stratified as well.
TEST_F(AdaptiveRender, IsNoWorseThanUniform) {
    for (const char *sampler : {"zsobol", "halton", "sobol", "pmj02bn"})
        for (const Noise place : {Noise::Right, Noise::Corner, Noise::SmoothLeft}) {
            double errors[2] = {};
            for (int seed = 1; seed <= 4; ++seed)
                for (const bool isAdaptive : {false, true})
                    errors[isAdaptive] +=
                        ImageError(Render(isAdaptive, 64, seed, place, 0, sampler).image, Truth(), Metric::RelL2);
            EXPECT_GT(errors[0] / errors[1], 0.95) << sampler << int(place);
        }
}

TEST_F(AdaptiveRender, EstimatesItsNoise) {
    double found = 0, estimated = 0;
    for (int seed = 1; seed <= 8; ++seed) {
        const Result r = Render(true, 128, seed);
        found += ImageError(r.image, Truth(), Metric::RelL2);
        estimated += Sqr(r.render.adaptive->noise.value());
    }
    EXPECT_NEAR(std::sqrt(estimated / found), 1, 0.1);
}

TEST_F(AdaptiveRender, StopsAtTheNoiseRequested) {
    for (const double noise : {0.3, 0.1}) {
        const Result r = Render(true, 4096, 1, Noise::Right, noise);
        EXPECT_LE(r.render.adaptive->noise.value(), noise);
        EXPECT_NEAR(std::sqrt(ImageError(r.image, Truth(), Metric::RelL2)) / noise, 1, 0.2);
    }
    EXPECT_EQ(Render(true, 64, 1, Noise::Right, 1e-6).render.samplesTaken, 64);
}

/// Samples that decide are part of the image. A bias would show in pixels whose first samples were all dark.
TEST_F(AdaptiveRender, IsUnbiased) {
    const double truth = double(Truth().Get({0, 0}, 1));
    const auto expectMean = [&](Noise place, int samples, int seeds, double limit) {
        RunningMoments means;
        int adaptive = 0;
        for (int seed = 0; seed < seeds; ++seed) {
            const Result r = Render(true, samples, seed, place);
            adaptive += r.render.adaptive->maxSamples > r.render.adaptive->minSamples;
            double sum = 0;
            ForEachPixel(r.image, [&](Point2i p) { sum += double(r.image.Get(p, 1)); });
            means.Add(sum / (kWidth * kHeight) / truth);
        }
        EXPECT_GT(adaptive, seeds / 2);
        const double error = std::sqrt(means.Variance() / double(means.Count()));
        EXPECT_LT(error, limit);
        EXPECT_NEAR(means.Mean(), 1, 3 * error);
    };
    expectMean(Noise::Right, 32, 160, 0.001);
    expectMean(Noise::RareRight, 128, 200, 0.004);
}

}  // namespace
}  // namespace pbrt
