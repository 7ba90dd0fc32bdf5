// Allocation of samples, predicted gain, and plans of adaptive renders.
#include <gtest/gtest.h>

#include <cmath>

#include "pbrt/integrators/adaptive_sampling.h"
#include "pbrt/math/rng.h"
#include "pbrt/math/statistics.h"

namespace pbrt {
namespace {

const Bounds2i kPixels{{3, 5}, {53, 42}};  // the last cells are smaller
const PixelCells kCells(kPixels);

std::vector<double> Variances(double value) { return std::vector<double>(kCells.Count(), value); }
std::vector<double> RandomVariances(Rng &rng, double exponent) {
    std::vector<double> variance;
    for (size_t i = 0; i < kCells.Count(); ++i) variance.push_back(std::exp(exponent * double(rng.Uniform())));
    return variance;
}
std::vector<double> VariancesWithTwoPeaks() {
    std::vector<double> variance = Variances(1);
    variance[8] = variance[17] = 1000;
    return variance;
}

/// An estimate of these variances by the pixels of both colours.
NoiseEstimate EstimateOf(const std::vector<double> &variance, double stratification = 1) {
    return {.own = variance, .others = variance, .stratification{std::vector(variance.size(), stratification)}};
}

SamplePlan UniformPlan(int samples) {
    SamplePlan plan{0, samples, {}, {}, {}};
    for (size_t i = 0; i < kCells.Count(); ++i) plan.cost.push_back(uint64_t(3 * samples) * kCells.PixelsIn(i));
    return plan;
}

TEST(PixelCells, ContainEachPixelOnce) {
    for (const Bounds2i &bounds : {kPixels, Bounds2i({-2, -3}, {-1, 6})}) {
        const PixelCells cells(bounds);
        int64_t pixels = 0;
        for (size_t i = 0; i < cells.Count(); ++i) {
            int count = 0;
            cells.ForPixels(i, [&](Point2i p) {
                ++count;
                EXPECT_EQ(cells.IndexOf(p), i);
                if (p.x + 1 < bounds.high.x && (p.x + 1 - bounds.low.x) % PixelCells::kSize != 0) {
                    EXPECT_EQ(cells.IndexOf(p + Vector2i(1, 0)), PixelCells::Other(i));
                }
            });
            EXPECT_EQ(count, cells.PixelsIn(i));
            pixels += count;
        }
        EXPECT_EQ(pixels, bounds.Area());
    }
}

TEST(SampleAllocation, SpendsWhatAUniformWaveWould) {
    EXPECT_EQ(kCells.Count(), 70u);
    Rng rng(7);
    const std::vector<double> variance = RandomVariances(rng, 6);
    SamplePlan plan = UniformPlan(16);
    for (const int end : {24, 36, 64}) {
        const SamplePlan next = AllocateSamples(kCells, plan, variance, plan.end, end);
        EXPECT_EQ(next.Validate(kCells, plan.end), std::nullopt);
        double added = 0;
        for (size_t i = 0; i < kCells.Count(); ++i) {
            added += double(kCells.PixelsIn(i)) * (next.after[i] - next.before[i]);
            EXPECT_EQ(next.before[i], plan.CountAt(i, plan.end));
            EXPECT_EQ((next.after[i] - next.before[i]) % plan.Group(), 0);
            EXPECT_LE(next.after[i], SamplePlan::kMaxGrowth * next.before[i] + plan.Group());
        }
        EXPECT_NEAR(added, double(kPixels.Area()) * (end - plan.end), 128);
        EXPECT_EQ(next.after, AllocateSamples(kCells, plan, variance, plan.end, end).after);
        plan = next;
    }
    // Proportional to the standard deviation, with a share for all.
    const auto [least, most] = std::ranges::minmax_element(variance);
    const int few = plan.after[least - variance.begin()], many = plan.after[most - variance.begin()];
    EXPECT_GT(many, 4 * few);
    EXPECT_LT(many, int(std::sqrt(*most / *least)) * few);
}

TEST(SampleAllocation, WithoutNoiseIsUniform) {
    EXPECT_EQ(AllocateSamples(kCells, UniformPlan(16), Variances(0), 16, 24).after,
              std::vector<int>(kCells.Count(), 24));
}

TEST(SampleAllocation, AnUnluckyZeroDoesNotStarve) {
    std::vector<double> variance = Variances(1);
    variance[3] = 0;
    SamplePlan plan = UniformPlan(16);
    while (plan.end < 1024) plan = AllocateSamples(kCells, plan, variance, plan.end, NextDecision(plan.end, 1024));
    EXPECT_GE(plan.after[3], 1024 / 16);
    EXPECT_LE(plan.after[3], 1024 / 8);
}

TEST(SampleAllocation, ExpensiveCellsGetFewer) {
    SamplePlan plan = UniformPlan(16);
    for (const size_t i : {0, 1}) plan.cost[i] = 15 * plan.cost[i] / 3;  // 16 with the camera's share, over 4
    plan = AllocateSamples(kCells, plan, Variances(1), 16, 48);
    EXPECT_NEAR(plan.after[0], plan.after[8] / 2, 4);
}

TEST(SampleAllocation, DecisionsIncludeThePlannedNumber) {
    EXPECT_EQ(PilotSamples(1, 1), 2);
    EXPECT_EQ(PilotSamples(16, 1), 4);
    EXPECT_EQ(PilotSamples(30, 1), 8);
    EXPECT_EQ(PilotSamples(4096, 1), 16);
    EXPECT_EQ(PilotSamples(64, 16), 32);
    for (const int planned : {5, 64, 100}) {
        bool isIncluded = false;
        for (int done = PilotSamples(planned, 1); done < 200; done = NextDecision(done, planned)) {
            isIncluded |= done == planned;
            EXPECT_GT(NextDecision(done, planned), done);
        }
        EXPECT_TRUE(isIncluded) << planned;
    }
}

/// Where all cells get samples: mean v / (mean (v / w) mean w) for a distribution w.
TEST(PredictedGain, IsThatOfTheDistribution) {
    Rng rng(3);
    const std::vector<double> variance = RandomVariances(rng, 4);
    const auto mean = [&](auto &&f) {
        double sum = 0;
        for (size_t i = 0; i < kCells.Count(); ++i) sum += double(kCells.PixelsIn(i)) * f(variance[i]);
        return sum / double(kPixels.Area());
    };
    const double share = 0.1 * mean([](double v) { return std::sqrt(v); });
    const auto wanted = [&](double v) { return std::sqrt(v) + share; };
    const double expected = mean([](double v) { return v; }) / mean([&](double v) { return v / wanted(v); }) /
                            mean([&](double v) { return wanted(v); });
    EXPECT_GT(expected, 1.1);
    const double gain = PredictGain(kCells, UniformPlan(2), EstimateOf(variance), 2, 1024);
    EXPECT_NEAR(gain / expected, 1, 1e-6);
    EXPECT_NEAR(PredictGain(kCells, UniformPlan(2), EstimateOf(Variances(3)), 2, 64), 1, 1e-6);
    EXPECT_EQ(PredictGain(kCells, UniformPlan(2), EstimateOf(Variances(0)), 2, 64), 1);
}

/// Slow twin: small amounts go to the cell that lacks most, from the samples that cells have.
TEST(PredictedGain, CountsTheSamplesTaken) {
    constexpr int kBegin = 16, kEnd = 28;
    constexpr double kStep = 1 / 128.0;
    Rng rng(5);
    const std::vector<double> variance = RandomVariances(rng, 4);
    SamplePlan plan = UniformPlan(kBegin);
    for (uint64_t &cost : plan.cost) cost = uint64_t(double(cost) * 3 * double(rng.Uniform()));
    std::vector<double> cost, wanted, samples(kCells.Count(), kBegin);
    double mean = 0;
    for (size_t i = 0; i < kCells.Count(); ++i) {
        const double pixels = double(kCells.PixelsIn(i));
        const size_t other = PixelCells::Other(i);
        cost.push_back(1 + double(plan.cost[other]) / (double(kCells.PixelsIn(other)) * kBegin));
        wanted.push_back(std::sqrt(variance[i] / cost[i]));
        mean += pixels * wanted[i] / double(kPixels.Area());
    }
    for (double &w : wanted) w += 0.1 * mean;
    for (double left = double(kPixels.Area()) * (kEnd - kBegin); left > 0;) {
        size_t next = 0;
        for (size_t i = 1; i < kCells.Count(); ++i)
            if (samples[i] / wanted[i] < samples[next] / wanted[next]) next = i;
        samples[next] += kStep;
        left -= kStep * double(kCells.PixelsIn(next));
    }
    double error[2] = {}, work[2] = {};
    for (size_t i = 0; i < kCells.Count(); ++i)
        for (const bool isPlanned : {false, true}) {
            const double pixels = double(kCells.PixelsIn(i)), n = isPlanned ? samples[i] : kEnd;
            error[isPlanned] += pixels * variance[i] / n;
            work[isPlanned] += pixels * cost[i] * n;
        }
    const double expected = error[0] * work[0] / (error[1] * work[1]);
    EXPECT_GT(expected, 1.02);
    EXPECT_NEAR(PredictGain(kCells, plan, EstimateOf(variance), kBegin, kEnd), expected, 0.002);
}

TEST(PredictedGain, IsNotTheNoiseOfTheEstimate) {
    Rng rng(11);
    RunningMoments independent, same;
    for (int repeat = 0; repeat < 50; ++repeat) {
        std::vector<double> estimates[2];
        for (std::vector<double> &e : estimates)
            for (size_t i = 0; i < kCells.Count(); ++i) e.push_back(-std::log(1 - double(rng.Uniform())));
        NoiseEstimate both = EstimateOf(estimates[0]);
        both.others = estimates[1];
        independent.Add(PredictGain(kCells, UniformPlan(2), both, 2, 256));
        same.Add(PredictGain(kCells, UniformPlan(2), EstimateOf(estimates[0]), 2, 256));
    }
    EXPECT_LT(independent.Mean(), 1);
    EXPECT_GT(same.Mean(), 1.1);
}

TEST(PlannedSamples, AreEqualWithoutGain) {
    const NoiseEstimate equal = EstimateOf(Variances(1));
    SamplePlan plan = PlanSamples(kCells, UniformPlan(16), equal, 16, 25, 64);
    EXPECT_TRUE(plan.before.empty());
    EXPECT_EQ(plan.CountAt(0, 21), 21);
    EXPECT_EQ(plan.uniformDecisions, 1);
    // The same decision of a resumed render.
    plan = PlanSamples(kCells, plan, equal, 16, 25, 64);
    EXPECT_EQ(plan.decisions, 1);
    EXPECT_EQ(plan.uniformDecisions, 1);
    EXPECT_EQ(plan.Validate(kCells, 20), std::nullopt);
}

TEST(PlannedSamples, BecomeEqualAgain) {
    SamplePlan plan = PlanSamples(kCells, UniformPlan(16), EstimateOf(VariancesWithTwoPeaks()), 16, 24, 64);
    EXPECT_GT(plan.gain, SamplePlan::kMinGain);
    EXPECT_GT(plan.after[8], plan.after[0]);
    EXPECT_EQ(plan.uniformDecisions, 0);
    const NoiseEstimate equal = EstimateOf(Variances(1));
    for (const int end : {36, 64, 96}) plan = PlanSamples(kCells, plan, equal, plan.end, end, 128);
    EXPECT_EQ(plan.decisions, 4);
    EXPECT_EQ(plan.uniformDecisions, 3);
    for (size_t i = 0; i < kCells.Count(); ++i) EXPECT_EQ(plan.CountAt(i, plan.end), 96);
}

TEST(PlannedSamples, StayEqualWhereStratificationGainsMore) {
    const std::vector<double> variance = VariancesWithTwoPeaks();
    SamplePlan plan = UniformPlan(16);
    plan.halfBlock = 4;
    const auto planned = [&](double stratification) {
        return PlanSamples(kCells, plan, EstimateOf(variance, stratification), 16, 24, 64);
    };
    const double gain = planned(1).gain;
    // Four doublings after the first block.
    EXPECT_NEAR(planned(1.1).gain, gain / std::pow(1.1, 4), 1e-9 * gain);
    EXPECT_TRUE(planned(gain).isUniform);
    // Unequal numbers have lost it already.
    plan = AllocateSamples(kCells, plan, variance, 16, 24);
    EXPECT_FALSE(PlanSamples(kCells, plan, EstimateOf(variance, gain), 24, 36, 64).isUniform);
}

/// Half of the cells are noisier, but converge faster.
TEST(PlannedSamples, AreEqualWhereTheNoisyCellsConverge) {
    SamplePlan plan = UniformPlan(8);
    plan.halfBlock = 4;
    std::vector<double> variance = Variances(16);
    const auto noisy = std::ptrdiff_t(kCells.Count() / 2);
    std::fill_n(variance.begin(), noisy, 100.0);
    NoiseEstimate estimate = EstimateOf(variance);
    EXPECT_FALSE(PlanSamples(kCells, plan, estimate, 8, 12, 64).isUniform);
    std::fill_n(estimate.stratification.begin(), noisy, 2.0);
    EXPECT_TRUE(PlanSamples(kCells, plan, estimate, 8, 12, 64).isUniform);
}

TEST(SamplePlans, CountTheSamplesOfTheHalf) {
    for (const int block : {1, 4, 16}) {
        SamplePlan plan;
        plan.halfBlock = block;
        for (const Point2i pixel : {Point2i(3, 6), Point2i(4, 7)}) {
            EXPECT_EQ(plan.BlockOf(pixel), pixel.y == 7 && block > 1 ? block / 4 : block);
            int count = 0;
            for (int sample = 0; sample < 96; ++sample) {
                EXPECT_EQ(plan.CountInHalf(pixel, sample), count);
                count += plan.IsInHalf(pixel, sample);
            }
            EXPECT_EQ(count, 48);
        }
    }
    EXPECT_EQ(HalfBlock(63, false), 4);
    EXPECT_EQ(HalfBlock(64, false), 16);
    EXPECT_EQ(HalfBlock(64, true), 1);
}

TEST(SamplePlans, OfOtherFilmsAreInvalid) {
    const SamplePlan good = AllocateSamples(kCells, UniformPlan(4), Variances(1), 4, 8);
    EXPECT_EQ(good.Validate(kCells, 6), std::nullopt);
    EXPECT_EQ(good.CountAt(0, 4), 4);
    EXPECT_EQ(good.CountAt(0, 6), 6);
    EXPECT_TRUE(good.Validate(kCells, 9));
    EXPECT_TRUE(good.Validate(PixelCells({{0, 0}, {8, 8}}), 6));
    for (int fault = 0; fault < 8; ++fault) {
        SamplePlan bad = good;
        if (fault == 0) bad.after[2] = bad.before[2] - 1;
        if (fault == 1) bad.after[2] = SamplePlan::kMaxCount + 1;
        if (fault == 2) bad.before[2] = -1;
        if (fault == 3) bad.cost.pop_back();
        if (fault == 4)
            for (int &count : bad.after) count += SamplePlan::kMaxGroup + 1;
        if (fault == 5) bad.isUniform = true;
        if (fault == 6) bad.uniformDecisions = bad.decisions + 1;
        if (fault == 7) bad.gain = std::nan("");
        EXPECT_TRUE(bad.Validate(kCells, 6)) << fault;
    }
}

}  // namespace
}  // namespace pbrt
