#pragma once
#include <optional>
#include <vector>

#include "pbrt/films/film.h"
#include "pbrt/films/sample_plan.h"

namespace pbrt {

// Adaptive sampling. A half film holds every second block of a pixel's samples (SamplePlan::halfBlock); the difference
// of the films estimates the noise. With RenderSettings::noise, blocks are single samples, which alternate between two
// independent sample sets. So the estimate is honest also for low-discrepancy samples, which lose some of their
// quality. Otherwise both halves are of one sequence, in blocks that are stratified. Equal numbers of samples gain from
// stratification beyond a block; that gain is estimated by cell, from blocks of two sizes.
// All functions depend on the films' sums only: any threads, processes and splits of a render decide alike.

struct NoiseEstimate {
    double relL2 = 0;  ///< expected error of the image (Metric::RelL2) against a noise-free reference
    /// Variance of one sample by cell, in relL2, outliers limited: `own` of the cell's pixels, 0 without pixels;
    /// `others` of the other colour, smoothed over neighbours. A cell's numbers of samples follow `others`, which are
    /// independent of its pixels: numbers that follow a pixel's own samples would bias it.
    std::vector<double> own, others;
    /// By cell: factor by which a doubling of the samples lowers the variance of one, as stratification does; at least
    /// 1, smoothed over neighbours of the same colour.
    std::vector<double> stratification;
};

/// `average`: samples per pixel of the films, see SamplePlan. Empty if a pixel lacks samples in one of the halves.
std::optional<NoiseEstimate> EstimateNoise(const Film &film, const Film &half, const SamplePlan &plan, int average);

/// SamplePlan::halfBlock of a render planned for `planned` samples per pixel.
int HalfBlock(int planned, bool hasIndependentHalves);
/// Number of samples per pixel of all pixels before the first decision: two blocks, or a quarter of `planned`.
int PilotSamples(int planned, int halfBlock);
/// Average samples per pixel at the decision after the one at `done`: 3/2 of them, but `planned` is not skipped.
int NextDecision(int done, int planned);
/// Average samples per pixel for this noise, extrapolated by the inverse square root.
double SamplesForNoise(int done, double estimated, double wanted);

/// Distributes the samples from `begin` to `end` per pixel on average: a cell gets samples in proportion to the square
/// root of its variance over its cost, counting those it has, which minimises relL2 times cost. All cells keep a small
/// share, and none gets more than four times the samples it has. `last`: plan up to `begin`. Adds multiples of
/// SamplePlan::Group.
SamplePlan AllocateSamples(const PixelCells &cells, const SamplePlan &last, const std::vector<double> &variance,
                           int begin, int end);

/// Predicted efficiency (the inverse of relL2 times cost) at `end` samples per pixel on average of the distribution
/// that AllocateSamples approaches over equal numbers, both as far as the samples taken permit. Planned by
/// NoiseEstimate::others, evaluated with NoiseEstimate::own: noise of the estimate does not look like gain. As long as
/// numbers are equal, further equal ones gain from stratification beyond a block; unequal ones are taken not to.
double PredictGain(const PixelCells &cells, const SamplePlan &last, const NoiseEstimate &estimate, int begin, int end);

/// Plan from `begin` to `end`: by AllocateSamples if PredictGain at `horizon`, the presumed end of the render, exceeds
/// SamplePlan::kMinGain or kMinFurtherGain; otherwise towards equal numbers. As long as these are equal, the samples
/// are those of a render that is not adaptive, unless the halves have independent sample sets.
SamplePlan PlanSamples(const PixelCells &cells, const SamplePlan &last, const NoiseEstimate &estimate, int begin,
                       int end, int horizon);

/// State of an adaptive render, for reports.
struct AdaptiveResult {
    double meanSamples = 0;  ///< per pixel
    int minSamples = 0, maxSamples = 0;
    int decisions = 0, uniformDecisions = 0;  ///< whose samples are taken, see SamplePlan
    double predictedGain = 0;                 ///< by the last decision, see PredictGain; 0: there is none
    std::optional<double> noise;              ///< estimated: the square root of relL2
};
AdaptiveResult DescribeAdaptive(const Film &film, const Film &half, const SamplePlan &plan, int average);

}  // namespace pbrt
