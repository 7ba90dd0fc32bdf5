// Estimates of noise, and the images of adaptive renders.
#include "pbrt/integrators/adaptive_sampling.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pbrt/core/progress.h"
#include "pbrt/images/metrics.h"
#include "pbrt/integrators/pixel_integrator.h"
#include "pbrt/integrators/render_loop.h"
#include "pbrt/math/statistics.h"
#include "support/render_scene.h"
#include "unit/pbrt/films/film_fixtures.h"

namespace pbrt::test {
namespace {

TEST(AdaptiveSampleIndices, AreDistinctSetsOfBothStreams) {
    std::vector<int> even, odd;
    for (int sample = 0; sample < 12; ++sample) (sample % 2 ? odd : even).push_back(AdaptiveSampleIndex(sample, 4));
    EXPECT_EQ(even, (std::vector<int>{0, 1, 2, 3, 8, 9}));
    EXPECT_EQ(odd, (std::vector<int>{4, 5, 6, 7, 12, 13}));
}

constexpr int kWidth = 64, kHeight = 48;
enum class Noise { None, Everywhere, Right, Corner, RareRight, SmoothLeft };

/// Radiance 1 in the mean: 1 / p with a probability that is small where the noise is.
class Spikes final : public PixelIntegrator {
  public:
    explicit Spikes(Noise noise) : noise_(noise) {}
    SampledSpectrum Li(const PathStart &start, SampledWavelengths &, Sampler &sampler) const override {
        const Float p = Probability(start.pixel), u = sampler.Get1D();
        if (noise_ != Noise::SmoothLeft) return SampledSpectrum(u < p ? 1 / p : Float(0));
        // Smooth, but noisier than the right half as long as samples are few; the right half is not stratified.
        if (2 * start.pixel.x < kWidth) return SampledSpectrum(20 * std::pow(u, Float(19)));
        const Float hash = u * 65536 - std::floor(u * 65536);
        return SampledSpectrum(hash < Float(0.3) ? 1 / Float(0.3) : Float(0));
    }

  private:
    Float Probability(Point2i pixel) const {
        switch (noise_) {
            case Noise::Everywhere: return Float(0.3);
            case Noise::Right: return 4 * pixel.x < 3 * kWidth ? Float(0.9) : Float(0.05);
            case Noise::RareRight: return 2 * pixel.x < kWidth ? Float(1) : Float(0.001);
            case Noise::Corner: return std::max(pixel.x, pixel.y) < kWidth / 4 ? Float(0.05) : Float(1);
            default: return 1;
        }
    }
    const Noise noise_;
};

class AdaptiveRender : public ::testing::Test {
  protected:
    struct Result {
        Image image;
        int samplesTaken;
        AdaptiveResult adaptive;
    };
    static Result Render(bool isAdaptive, int samples, int seed, Noise place = Noise::Right, double noise = 0,
                         const char *samplerName = "independent") {
        DiagnosticSink sink;
        const auto film = MakeFullFloat("rgb", FilmSize(kWidth, kHeight)), half = film->MakeRgbFilm();
        const auto filter = Filters().Make("box", ParamSet(), FilterContext{sink});
        const auto camera = Cameras().Make("orthographic", ParamSet(),
                                           CameraContext{AnimatedTransform(), {kWidth, kHeight}, 35, {}, sink});
        const int setSize = noise > 0 ? (samples + 1) / 2 : samples;
        const auto sampler =
            Samplers().Make(samplerName, ParamSet(), SamplerContext{{kWidth, kHeight}, setSize, seed, sink});
        Spikes integrator(place);
        Progress progress;
        RenderSettings settings;
        settings.samplesPerPixel = samples;
        settings.disableWavelengthJitter = true;
        settings.noise = noise;
        const RenderResult result = RenderWaves(
            {integrator, *camera, *filter, *film, *sampler, progress, Team::Alone(), isAdaptive ? half.get() : nullptr},
            settings);
        return {film->ToImage(), result.samplesTaken, result.adaptive.value_or(AdaptiveResult())};
    }
    static const Image &Truth() {
        static const Image image = Render(false, 1, 0, Noise::None).image;
        return image;
    }
    static double Error(const Image &image) { return ImageError(image, Truth(), Metric::RelL2); }
    /// Error of uniform renders over that of adaptive ones.
    static double Gain(int samples, int seeds, Noise place = Noise::Right, const char *sampler = "independent") {
        double errors[2] = {};
        for (int seed = 1; seed <= seeds; ++seed)
            for (const bool isAdaptive : {false, true})
                errors[isAdaptive] += Error(Render(isAdaptive, samples, seed, place, 0, sampler).image);
        return errors[0] / errors[1];
    }
};

TEST_F(AdaptiveRender, SpendsItsSamplesWhereTheNoiseIs) {
    const Result r = Render(true, 128, 1);
    EXPECT_EQ(r.samplesTaken, 128);
    EXPECT_NEAR(r.adaptive.meanSamples, 128, 0.1);
    EXPECT_GT(r.adaptive.maxSamples, 4 * r.adaptive.minSamples);
    EXPECT_GT(Gain(128, 8), 2);
}

TEST_F(AdaptiveRender, OfEqualNoiseIsTheUniformImage) {
    for (const char *sampler : {"zsobol", "independent"})
        for (const int samples : {37, 96})
            for (const Noise place : {Noise::Everywhere, Noise::None}) {
                const Result r = Render(true, samples, 2, place, 0, sampler);
                EXPECT_GT(r.adaptive.decisions, 2);
                EXPECT_EQ(r.adaptive.uniformDecisions, r.adaptive.decisions);
                EXPECT_EQ(r.adaptive.minSamples, samples);
                EXPECT_EQ(r.adaptive.maxSamples, samples);
                EXPECT_LT(r.adaptive.predictedGain, 1.15);
                // Other samplers would lose stratification.
                EXPECT_GT(r.adaptive.predictedGain, std::string_view(sampler) == "independent" ? 0.85 : 0);
                EXPECT_TRUE(SameBits(r.image, Render(false, samples, 2, place, 0, sampler).image))
                    << sampler << samples;
            }
}

TEST_F(AdaptiveRender, OfNoiseInACornerIsNotUniform) {
    const AdaptiveResult result = Render(true, 128, 2, Noise::Corner).adaptive;
    EXPECT_EQ(result.decisions, 4);
    EXPECT_EQ(result.uniformDecisions, 0);
    EXPECT_GT(result.predictedGain, SamplePlan::kMinGain);
    EXPECT_GT(result.maxSamples, 4 * result.minSamples);
}

/// Samplers whose first samples are stratified as well.
TEST_F(AdaptiveRender, IsNoWorseThanUniform) {
    for (const char *sampler : {"zsobol", "halton", "sobol", "pmj02bn"})
        for (const Noise place : {Noise::Right, Noise::Corner, Noise::SmoothLeft})
            EXPECT_GT(Gain(64, 4, place, sampler), 0.95) << sampler << int(place);
}

TEST_F(AdaptiveRender, EstimatesItsNoise) {
    double found = 0, estimated = 0;
    for (int seed = 1; seed <= 8; ++seed) {
        const Result r = Render(true, 128, seed);
        found += Error(r.image);
        estimated += Sqr(r.adaptive.noise.value());
    }
    EXPECT_NEAR(std::sqrt(estimated / found), 1, 0.1);
}

TEST_F(AdaptiveRender, StopsAtTheNoiseRequested) {
    for (const double noise : {0.3, 0.1}) {
        const Result r = Render(true, 4096, 1, Noise::Right, noise);
        EXPECT_LE(r.adaptive.noise.value(), noise);
        EXPECT_NEAR(std::sqrt(Error(r.image)) / noise, 1, 0.2);
    }
    EXPECT_EQ(Render(true, 64, 1, Noise::Right, 1e-6).samplesTaken, 64);
}

/// Samples that decide are part of the image. A bias would show in pixels whose first samples were all dark.
TEST_F(AdaptiveRender, IsUnbiased) {
    const double truth = double(Truth().Get({0, 0}, 1));
    const auto expectMean = [&](Noise place, int samples, int seeds, double limit) {
        RunningMoments means;
        int adaptive = 0;
        for (int seed = 0; seed < seeds; ++seed) {
            const Result r = Render(true, samples, seed, place);
            adaptive += r.adaptive.maxSamples > r.adaptive.minSamples;
            means.Add(ChannelStatistics(r.image).mean / truth);
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
}  // namespace pbrt::test
