// Estimates of noise, allocation of samples, and the images of adaptive renders.
#include "pbrt/integrators/adaptive_sampling.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pbrt/core/progress.h"
#include "pbrt/images/metrics.h"
#include "pbrt/integrators/pixel_integrator.h"
#include "pbrt/integrators/render_loop.h"
#include "pbrt/math/rng.h"
#include "pbrt/math/statistics.h"
#include "support/param.h"

namespace pbrt {
namespace {

const Bounds2i kPixels{{3, 5}, {53, 42}};  // the last cells are smaller

SamplePlan UniformPlan(const PixelCells &cells, int samples) {
    SamplePlan plan{0, samples, {}, {}, {}};
    for (size_t i = 0; i < cells.Count(); ++i) plan.cost.push_back(uint64_t(3 * samples) * cells.PixelsOf(i).Area());
    return plan;
}

double Added(const PixelCells &cells, const SamplePlan &plan) {
    double added = 0;
    for (size_t i = 0; i < cells.Count(); ++i)
        added += double(cells.PixelsOf(i).Area()) * (plan.after[i] - plan.before[i]);
    return added;
}

TEST(SampleAllocation, SpendsWhatAUniformWaveWould) {
    const PixelCells cells(kPixels);
    EXPECT_EQ(cells.Count(), 35u);
    Rng rng(7);
    std::vector<double> variance;
    for (size_t i = 0; i < cells.Count(); ++i) variance.push_back(std::exp(6.0 * double(rng.Uniform())));
    SamplePlan plan = UniformPlan(cells, 16);
    for (const int end : {24, 36, 64}) {
        const SamplePlan next = AllocateSamples(cells, plan, variance, plan.end, end);
        EXPECT_EQ(next.Validate(cells, plan.end), std::nullopt);
        EXPECT_NEAR(Added(cells, next), double(kPixels.Area()) * (end - plan.end), 128);
        for (size_t i = 0; i < cells.Count(); ++i) {
            EXPECT_EQ(next.before[i], plan.CountAt(i, plan.end));
            EXPECT_EQ((next.after[i] - next.before[i]) % 2, 0);
            EXPECT_LE(next.after[i], SamplePlan::kMaxGrowth * next.before[i] + 2);
        }
        EXPECT_EQ(next.after, AllocateSamples(cells, plan, variance, plan.end, end).after);
        plan = next;
    }
    // Proportional to the standard deviation, with a share for all.
    const auto [least, most] = std::ranges::minmax_element(variance);
    const int few = plan.after[least - variance.begin()], many = plan.after[most - variance.begin()];
    EXPECT_GT(many, 4 * few);
    EXPECT_LT(many, int(std::sqrt(*most / *least)) * few);
}

TEST(SampleAllocation, WithoutNoiseIsUniform) {
    const PixelCells cells(kPixels);
    const SamplePlan plan = AllocateSamples(cells, UniformPlan(cells, 16), std::vector<double>(cells.Count()), 16, 24);
    for (const int count : plan.after) EXPECT_EQ(count, 24);
}

TEST(SampleAllocation, AnUnluckyZeroDoesNotStarve) {
    const PixelCells cells(kPixels);
    std::vector<double> variance(cells.Count(), 1);
    variance[3] = 0;
    SamplePlan plan = UniformPlan(cells, 16);
    while (plan.end < 1024) plan = AllocateSamples(cells, plan, variance, plan.end, NextDecision(plan.end, 1024));
    EXPECT_GE(plan.after[3], 1024 / 16);
    EXPECT_LE(plan.after[3], 1024 / 8);
}

TEST(SampleAllocation, ExpensiveCellsGetFewer) {
    const PixelCells cells(kPixels);
    SamplePlan plan = UniformPlan(cells, 16);
    plan.cost[0] = 15 * plan.cost[0] / 3;  // 16 with the camera's share, over 4
    plan = AllocateSamples(cells, plan, std::vector<double>(cells.Count(), 1), 16, 48);
    EXPECT_NEAR(plan.after[0], plan.after[8] / 2, 4);
}

TEST(SampleAllocation, DecisionsIncludeThePlannedNumber) {
    EXPECT_EQ(PilotSamples(1), 2);
    EXPECT_EQ(PilotSamples(16), 4);
    EXPECT_EQ(PilotSamples(30), 8);
    EXPECT_EQ(PilotSamples(4096), 16);
    for (const int planned : {5, 64, 100}) {
        bool isIncluded = false;
        for (int done = PilotSamples(planned); done < 200; done = NextDecision(done, planned)) {
            isIncluded |= done == planned;
            EXPECT_GT(NextDecision(done, planned), done);
        }
        EXPECT_TRUE(isIncluded) << planned;
    }
}

TEST(SamplePlans, OfOtherFilmsAreInvalid) {
    const PixelCells cells(kPixels);
    const SamplePlan good = AllocateSamples(cells, UniformPlan(cells, 4), std::vector<double>(cells.Count(), 1), 4, 8);
    EXPECT_EQ(good.Validate(cells, 6), std::nullopt);
    EXPECT_EQ(good.CountAt(0, 4), 4);
    EXPECT_EQ(good.CountAt(0, 6), 6);
    EXPECT_TRUE(good.Validate(cells, 9));
    EXPECT_TRUE(good.Validate(PixelCells({{0, 0}, {8, 8}}), 6));
    for (int fault = 0; fault < 5; ++fault) {
        SamplePlan bad = good;
        if (fault == 0) bad.after[2] = bad.before[2] - 1;
        if (fault == 1) bad.after[2] = SamplePlan::kMaxCount + 1;
        if (fault == 2) bad.before[2] = -1;
        if (fault == 3) bad.cost.pop_back();
        if (fault == 4)
            for (int &count : bad.after) count += 2;
        EXPECT_TRUE(bad.Validate(cells, 6)) << fault;
    }
}

TEST(AdaptiveSampleIndices, AreDistinctSetsOfBothStreams) {
    std::vector<int> even, odd;
    for (int sample = 0; sample < 12; ++sample) (sample % 2 ? odd : even).push_back(AdaptiveSampleIndex(sample, 4));
    EXPECT_EQ(even, (std::vector<int>{0, 1, 2, 3, 8, 9}));
    EXPECT_EQ(odd, (std::vector<int>{4, 5, 6, 7, 12, 13}));
}

/// Radiance 1 in the mean: 1 / p with a probability that is small on the right; 1 without noise.
class Spikes final : public PixelIntegrator {
  public:
    explicit Spikes(int width, bool isNoisy) : width_(width), isNoisy_(isNoisy) {}
    SampledSpectrum Li(const PathStart &start, SampledWavelengths &, Sampler &sampler) const override {
        const Float p = !isNoisy_ ? Float(1) : 4 * start.pixel.x < 3 * width_ ? Float(0.9) : Float(0.05);
        return SampledSpectrum(sampler.Get1D() < p ? 1 / p : Float(0));
    }

  private:
    int width_;
    bool isNoisy_;
};

class AdaptiveRender : public ::testing::Test {
  protected:
    static constexpr int kWidth = 64, kHeight = 48;

    struct Result {
        Image image;
        RenderResult render;
    };
    static Result Render(bool isAdaptive, int samples, int seed, bool isNoisy = true, double noise = 0) {
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
        const auto sampler = Samplers().Make("independent", ParamSet(),
                                             SamplerContext{{kWidth, kHeight}, (samples + 1) / 2, seed, sink});
        Spikes integrator(kWidth, isNoisy);
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
        static const Image image = Render(false, 1, 0, false).image;
        return image;
    }
};

TEST_F(AdaptiveRender, SpendsItsSamplesWhereTheNoiseIs) {
    const Result adaptive = Render(true, 64, 1);
    ASSERT_TRUE(adaptive.render.adaptive);
    EXPECT_EQ(adaptive.render.samplesTaken, 64);
    EXPECT_NEAR(adaptive.render.adaptive->meanSamples, 64, 0.1);
    EXPECT_GT(adaptive.render.adaptive->maxSamples, 4 * adaptive.render.adaptive->minSamples);
    double errors[2] = {};
    for (int seed = 1; seed <= 8; ++seed)
        for (const bool isAdaptive : {false, true})
            errors[isAdaptive] += ImageError(Render(isAdaptive, 64, seed).image, Truth(), Metric::RelL2);
    EXPECT_GT(errors[0] / errors[1], 2);
}

TEST_F(AdaptiveRender, EstimatesItsNoise) {
    double found = 0, estimated = 0;
    for (int seed = 1; seed <= 8; ++seed) {
        const Result r = Render(true, 64, seed);
        found += ImageError(r.image, Truth(), Metric::RelL2);
        estimated += Sqr(r.render.adaptive->noise.value());
    }
    EXPECT_NEAR(std::sqrt(estimated / found), 1, 0.1);
}

TEST_F(AdaptiveRender, StopsAtTheNoiseRequested) {
    for (const double noise : {0.3, 0.1}) {
        const Result r = Render(true, 4096, 1, true, noise);
        EXPECT_LE(r.render.adaptive->noise.value(), noise);
        EXPECT_NEAR(std::sqrt(ImageError(r.image, Truth(), Metric::RelL2)) / noise, 1, 0.2);
    }
    EXPECT_EQ(Render(true, 64, 1, true, 1e-6).render.samplesTaken, 64);
}

/// Samples that decide are part of the image. A bias would show in pixels whose first samples were all dark.
TEST_F(AdaptiveRender, IsUnbiased) {
    const double truth = double(Truth().Get({0, 0}, 1));
    RunningMoments means;
    for (int seed = 0; seed < 160; ++seed) {
        const Image image = Render(true, 32, seed).image;
        double sum = 0;
        ForEachPixel(image, [&](Point2i p) { sum += double(image.Get(p, 1)); });
        means.Add(sum / (kWidth * kHeight) / truth);
    }
    const double error = std::sqrt(means.Variance() / double(means.Count()));
    EXPECT_LT(error, 0.001);
    EXPECT_NEAR(means.Mean(), 1, 3 * error);
}

}  // namespace
}  // namespace pbrt
