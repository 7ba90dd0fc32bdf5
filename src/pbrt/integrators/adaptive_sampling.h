#pragma once
#include <optional>
#include <vector>

#include "pbrt/films/film.h"
#include "pbrt/films/sample_plan.h"

namespace pbrt {

// Adaptive sampling. A half film holds every second sample of a pixel; the difference of the films estimates the noise.
// With RenderSettings::noise, the samples alternate between two independent sample sets. So the estimate is honest also
// for low-discrepancy samples, which lose some of their quality. Otherwise the halves are of one sequence, and the
// estimate is too large where low-discrepancy samples gain much.
// All functions depend on the films' sums only: any threads, processes and splits of a render decide alike.

struct NoiseEstimate {
    double relL2 = 0;              ///< expected error of the image (Metric::RelL2) against a noise-free reference
    std::vector<double> variance;  ///< of one sample, in relL2, by cell: smoothed over neighbours, outliers limited
};

/// `average`: samples per pixel of the films, see SamplePlan. Empty if a pixel has fewer than two.
std::optional<NoiseEstimate> EstimateNoise(const Film &film, const Film &half, const SamplePlan &plan, int average);

/// Number of samples per pixel of all pixels before the first decision, in a render planned for `planned`.
int PilotSamples(int planned);
/// Average samples per pixel at the decision after the one at `done`: 3/2 of them, but `planned` is not skipped.
int NextDecision(int done, int planned);
/// Average samples per pixel for this noise, extrapolated by the inverse square root.
double SamplesForNoise(int done, double estimated, double wanted);

/// Distributes the samples from `begin` to `end` per pixel on average: a cell gets samples in proportion to the square
/// root of its variance over its cost, counting those it has, which minimises relL2 times cost. All cells keep a small
/// share, and none gets more than four times the samples it has. `last`: plan up to `begin`. Adds even numbers, as both
/// sample sets grow alike.
SamplePlan AllocateSamples(const PixelCells &cells, const SamplePlan &last, const std::vector<double> &variance,
                           int begin, int end);

/// State of an adaptive render, for reports.
struct AdaptiveResult {
    double meanSamples = 0;  ///< per pixel
    int minSamples = 0, maxSamples = 0;
    std::optional<double> noise;  ///< estimated: the square root of relL2
};
AdaptiveResult DescribeAdaptive(const Film &film, const Film &half, const SamplePlan &plan, int average);

}  // namespace pbrt
