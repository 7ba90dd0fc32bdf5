#include "pbrt/integrators/adaptive_sampling.h"

#include <algorithm>
#include <cmath>

#include "pbrt/core/parallel.h"
#include "pbrt/images/metrics.h"

namespace pbrt {
namespace {

constexpr int kIndependentPilot = 16, kBlock = SamplePlan::kMaxGroup;  ///< samples per pixel
constexpr double kMaxOutlier = 16;        ///< a pixel's variance over the mean of its neighbourhood
constexpr double kUniformShare = 0.1;     ///< added to the square root of the variance, over its mean
constexpr double kMaxStratification = 4;  ///< of a smooth integrand with scrambled nets

/// Means of all samples and of those in the half film, and their numbers per pixel.
struct Halves {
    Image all, half;
    const SamplePlan &plan;
    std::vector<int> counts;  ///< by cell
    PixelCells cells;
    Point2i low;

    int CountAt(Point2i p) const { return counts[cells.IndexOf(low + p)]; }
    int CountInHalf(Point2i p) const { return plan.CountInHalf(low + p, CountAt(p)); }
    /// The smaller mean of both halves: outliers are in one of them.
    double Smaller(Point2i p, int c) const {
        const int n = CountAt(p), n1 = CountInHalf(p);
        const double a = double(all.Get(p, c)), b = double(half.Get(p, c));
        return std::max(0.0, std::min(b, (n * a - n1 * b) / (n - n1)));
    }
    /// Estimate of the variance of the pixel's value.
    double Variance(Point2i p, int c) const {
        const int n = CountAt(p), n1 = CountInHalf(p);
        const double d = double(all.Get(p, c)) - double(half.Get(p, c));
        return d * d * n1 / (n - n1);
    }
    /// Standard deviation of one sample in a cell, from pixels with short blocks or the others, times the number of
    /// these pixels. Absolute, so that it does not depend on the number of samples if these are independent; outliers
    /// count little.
    double Deviation(size_t cell, bool ofShortBlocks) const {
        double sum = 0;
        int pixels = 0;
        cells.ForPixels(cell, [&](Point2i pixel) {
            if (plan.HasShortBlocks(pixel) != ofShortBlocks) return;
            ++pixels;
            for (int c = 0; c < 3; ++c) sum += Variance(pixel - low, c);
        });
        return std::sqrt(counts[cell] * sum * pixels);
    }
};

/// Relative squared error of each pixel. Its denominator excludes the pixel's outliers, which would hide their own
/// error. It is at least the mean square of the neighbours of the same colour, as the square of a noisy dark pixel is
/// too small; there, the mean times the smaller half is nearly unbiased.
std::vector<double> RelativeErrors(const Halves &halves) {
    const Point2i size = halves.all.Resolution();
    std::vector<glm::dvec3> squares(size_t(size.x) * size.y), smaller(squares.size());
    const auto forRows = [&](auto &&f) {
        ParallelForEach(size.y, 8, [&](int64_t y) {
            for (int x = 0; x < size.x; ++x) f(Point2i(x, int(y)), size_t(y) * size.x + x);
        });
    };
    forRows([&](Point2i p, size_t i) {
        for (int c = 0; c < 3; ++c) {
            smaller[i][c] = halves.Smaller(p, c);
            squares[i][c] = smaller[i][c] * double(halves.all.Get(p, c));
        }
    });
    const double epsilon = RelL2Epsilon(halves.all);
    std::vector<double> errors(squares.size());
    forRows([&](Point2i p, size_t i) {
        const Point2i low = glm::max(p - 2, Point2i(0)), high = glm::min(p + 2, size - 1);
        glm::dvec3 sum = -squares[i];
        int count = -1;
        for (int y = low.y; y <= high.y; ++y)
            for (int x = low.x + (low.x + y + p.x + p.y) % 2; x <= high.x; x += 2, ++count)
                sum += squares[size_t(y) * size.x + x];
        for (int c = 0; c < 3; ++c) {
            const double around = sum[c] / std::max(1, count);
            const double term = halves.Variance(p, c) / (std::max(Sqr(smaller[i][c]), around) + epsilon) / 3;
            if (std::isfinite(term)) errors[i] += term;
        }
    });
    return errors;
}

double RatioOrZero(double a, double b) { return b > 0 ? a / b : 0; }

/// Sums over the cells and their neighbours.
std::vector<double> WithNeighbours(const PixelCells &cells, const std::vector<double> &values) {
    std::vector<double> sums(values.size());
    for (size_t cell = 0; cell < sums.size(); ++cell)
        cells.ForNeighbours(cell, [&](size_t i) { sums[cell] += values[i]; });
    return sums;
}

std::vector<int> CountsOf(const PixelCells &cells, const SamplePlan &plan, int average) {
    std::vector<int> counts(cells.Count());
    for (size_t i = 0; i < counts.size(); ++i) counts[i] = plan.CountAt(i, average);
    return counts;
}

/// Samples, and their cost, of the cells of a plan at an average number of samples per pixel.
class CellWork {
  public:
    CellWork(const PixelCells &cells, const SamplePlan &plan, int average)
        : before_(CountsOf(cells, plan, average)), pixels_(before_.size()), cost_(before_.size()) {
        for (size_t i = 0; i < before_.size(); ++i) {
            pixels_[i] = cells.PixelsIn(i);
            // The camera's and the film's work is about that of a ray. As the variance, of the other pixels.
            const size_t other = PixelCells::Other(i);
            cost_[i] = 1 + RatioOrZero(double(plan.cost[other]), double(cells.PixelsIn(other)) * before_[other]);
        }
    }
    const std::vector<int> &Before() const { return before_; }
    double Pixels(size_t cell) const { return pixels_[cell]; }
    bool AreEqual() const { return std::ranges::adjacent_find(before_, std::not_equal_to<>()) == before_.end(); }

    /// Samples per pixel to add to each cell for `end` on average: towards a distribution in proportion to the square
    /// root of variance over cost, with at most `maxGrowth` times the samples of a cell. Zero variances: towards equal
    /// numbers.
    std::vector<double> Added(const std::vector<double> &variance, int end, int maxGrowth) const {
        std::vector<double> wanted(variance.size());
        double area = 0, sum = 0;
        for (size_t i = 0; i < wanted.size(); ++i) {
            wanted[i] = std::sqrt(variance[i] / cost_[i]);
            area += pixels_[i];
            sum += pixels_[i] * wanted[i];
        }
        for (double &w : wanted) w = sum > 0 ? w + kUniformShare * sum / area : 1;
        const auto maxAdded = [&](size_t i) {
            return std::min(double(maxGrowth) * before_[i], double(SamplePlan::kMaxCount)) - before_[i];
        };
        double largest = 0, budget = 0;
        for (size_t i = 0; i < wanted.size(); ++i) {
            budget += pixels_[i] * (end - before_[i]);
            largest = std::max(largest, (maxAdded(i) + before_[i]) / wanted[i]);
        }
        std::vector<double> added(wanted.size());
        // Bisection: the number of samples grows with the scale.
        double low = 0, high = largest;
        for (int step = 0; step <= kBisections; ++step) {
            const double scale = step < kBisections ? (low + high) / 2 : high;
            double samples = 0;
            for (size_t i = 0; i < wanted.size(); ++i) {
                added[i] = std::clamp(scale * wanted[i] - before_[i], 0.0, maxAdded(i));
                samples += pixels_[i] * added[i];
            }
            (samples < budget ? low : high) = scale;
        }
        return added;
    }

    /// Sums over all pixels of error and cost, for a variance of one sample by cell.
    struct Outcome {
        double error = 0, cost = 0;
    };
    Outcome Evaluate(const std::vector<double> &added, const std::vector<double> &variance) const {
        Outcome outcome;
        for (size_t i = 0; i < added.size(); ++i) {
            const double samples = before_[i] + added[i];
            outcome.error += pixels_[i] * variance[i] / samples;
            outcome.cost += pixels_[i] * cost_[i] * samples;
        }
        return outcome;
    }

  private:
    static constexpr int kBisections = 60;

    std::vector<int> before_;            ///< samples per pixel
    std::vector<double> pixels_, cost_;  ///< cost of one sample, in rays
};

/// NoiseEstimate::stratification: long blocks are two doublings of short ones.
std::vector<double> MeasureStratification(const Halves &halves) {
    const auto deviations = [&](bool ofShortBlocks) {
        std::vector<double> sums(halves.cells.Count());
        for (size_t i = 0; i < sums.size(); ++i) sums[i] = halves.Deviation(i, ofShortBlocks);
        return WithNeighbours(halves.cells, WithNeighbours(halves.cells, sums));
    };
    const std::vector<double> ofShort = deviations(true), ofLong = deviations(false);
    std::vector<double> result;
    for (size_t i = 0; i < ofShort.size(); ++i)
        result.push_back(std::clamp(RatioOrZero(ofShort[i], ofLong[i]), 1.0, kMaxStratification));
    return result;
}

}  // namespace

std::optional<NoiseEstimate> EstimateNoise(const Film &film, const Film &half, const SamplePlan &plan, int average) {
    const PixelCells cells(film.PixelBounds());
    const Halves halves{film.Colors(), half.Colors(),         plan, CountsOf(cells, plan, average),
                        cells,         film.PixelBounds().low};
    if (halves.counts.empty() || std::ranges::min(halves.counts) <= plan.halfBlock) return {};
    const std::vector<double> errors = RelativeErrors(halves);
    const int width = halves.all.Resolution().x;
    // Pixels with short blocks do not count, unless all are: a single row.
    const bool areAllShort = film.PixelBounds().Height() == 1 && plan.HasShortBlocks(halves.low);
    const auto counts = [&](Point2i pixel) { return areAllShort || !plan.HasShortBlocks(pixel); };
    // Sum over a cell of the variance of one sample, of at most `limit` a pixel.
    const auto sumOf = [&](size_t cell, double limit) {
        double sum = 0;
        cells.ForPixels(cell, [&](Point2i pixel) {
            const Point2i p = pixel - halves.low;
            if (counts(pixel)) sum += std::min(limit, halves.counts[cell] * errors[size_t(p.y) * width + p.x]);
        });
        return sum;
    };
    NoiseEstimate estimate;
    std::vector<double> pixels(cells.Count()), sums, limited;
    double allPixels = 0;
    for (size_t i = 0; i < cells.Count(); ++i) {
        cells.ForPixels(i, [&](Point2i pixel) { pixels[i] += counts(pixel); });
        sums.push_back(sumOf(i, Infinity));
        estimate.relL2 += sums[i] / halves.counts[i];
        allPixels += pixels[i];
    }
    estimate.relL2 /= allPixels;
    const std::vector<double> pixelsAround = WithNeighbours(cells, pixels), sumsAround = WithNeighbours(cells, sums);
    for (size_t i = 0; i < cells.Count(); ++i)
        limited.push_back(sumOf(i, kMaxOutlier * RatioOrZero(sumsAround[i], pixelsAround[i])));
    const std::vector<double> limitedAround = WithNeighbours(cells, limited);
    for (size_t i = 0; i < cells.Count(); ++i) {
        const size_t other = PixelCells::Other(i);
        estimate.own.push_back(RatioOrZero(limited[i], pixels[i]));
        estimate.others.push_back(RatioOrZero(limitedAround[other], pixelsAround[other]));
    }
    estimate.stratification = MeasureStratification(halves);
    return estimate;
}

int HalfBlock(int planned, bool hasIndependentHalves) {
    if (hasIndependentHalves) return 1;
    return planned >= 4 * kBlock ? kBlock : kBlock / 4;
}

int PilotSamples(int planned, int halfBlock) {
    return halfBlock > 1 ? 2 * halfBlock : std::clamp((planned / 4 + 1) / 2 * 2, 2, kIndependentPilot);
}

int NextDecision(int done, int planned) {
    const int next = std::min(done + std::max(2, done / 4 * 2), SamplePlan::kMaxCount);
    return done < planned ? std::min(next, planned) : next;
}

double SamplesForNoise(int done, double estimated, double wanted) { return done * Sqr(estimated / wanted); }

SamplePlan AllocateSamples(const PixelCells &cells, const SamplePlan &last, const std::vector<double> &variance,
                           int begin, int end) {
    const CellWork work(cells, last, begin);
    const std::vector<double> added = work.Added(variance, end, SamplePlan::kMaxGrowth);
    SamplePlan plan = last;
    plan.begin = begin;
    plan.end = end;
    plan.before = work.Before();
    plan.after.clear();
    const double group = plan.Group();
    double owed = 0;  // samples that rounding left over
    for (size_t i = 0; i < added.size(); ++i) {
        const double exact = added[i], pixels = work.Pixels(i);
        owed += pixels * exact;
        const double due = pixels > 0 ? owed / pixels : exact;
        const int groups =
            int(std::clamp(std::round(due / group), std::floor(exact / group), std::ceil(exact / group)));
        plan.after.push_back(std::min(plan.before[i] + groups * int(group), SamplePlan::kMaxCount));
        owed -= pixels * (plan.after[i] - plan.before[i]);
    }
    return plan;
}

double PredictGain(const PixelCells &cells, const SamplePlan &last, const NoiseEstimate &estimate, int begin, int end) {
    const CellWork work(cells, last, begin);
    const auto outcome = [&](const std::vector<double> &planned, const std::vector<double> &variance) {
        return work.Evaluate(work.Added(planned, end, SamplePlan::kMaxCount), variance);
    };
    std::vector<double> stratified = estimate.own;
    const double doublings = std::max(0.0, std::log2(double(end) / last.halfBlock));
    for (size_t i = 0; i < stratified.size() && work.AreEqual(); ++i)
        stratified[i] *= std::pow(estimate.stratification[i], -doublings);
    const CellWork::Outcome uniform = outcome(std::vector<double>(cells.Count()), stratified),
                            adaptive = outcome(estimate.others, estimate.own);
    return adaptive.error > 0 ? uniform.error / adaptive.error * (uniform.cost / adaptive.cost) : 1;
}

SamplePlan PlanSamples(const PixelCells &cells, const SamplePlan &last, const NoiseEstimate &estimate, int begin,
                       int end, int horizon) {
    SamplePlan plan = last;
    // A decision that is made again, of a resumed render, counts once.
    const bool isAgain = last.decisions > 0 && last.begin == begin;
    const bool areEqual = CellWork(cells, last, begin).AreEqual();
    plan.gain = PredictGain(cells, last, estimate, begin, horizon);
    plan.isUniform = !(plan.gain > (areEqual ? SamplePlan::kMinGain : SamplePlan::kMinFurtherGain));
    plan.decisions += isAgain ? 0 : 1;
    plan.uniformDecisions += int(plan.isUniform) - int(isAgain && last.isUniform);
    if (!plan.isUniform) return AllocateSamples(cells, plan, estimate.others, begin, end);
    if (!areEqual) return AllocateSamples(cells, plan, std::vector<double>(cells.Count()), begin, end);
    plan.begin = begin;
    plan.end = end;
    plan.before.clear();
    plan.after.clear();
    return plan;
}

AdaptiveResult DescribeAdaptive(const Film &film, const Film &half, const SamplePlan &plan, int average) {
    const PixelCells cells(film.PixelBounds());
    const std::vector<int> counts = CountsOf(cells, plan, average);
    AdaptiveResult result;
    for (size_t i = 0; i < counts.size(); ++i) {
        const int pixels = cells.PixelsIn(i);
        if (pixels == 0) continue;
        result.minSamples = result.maxSamples == 0 ? counts[i] : std::min(result.minSamples, counts[i]);
        result.maxSamples = std::max(result.maxSamples, counts[i]);
        result.meanSamples += double(pixels) * counts[i];
    }
    result.meanSamples /= double(film.PixelBounds().Area());
    const bool isBegun = average > plan.begin || plan.decisions == 0;  // else the last decision is not followed
    result.decisions = plan.decisions - int(!isBegun);
    result.uniformDecisions = plan.uniformDecisions - int(!isBegun && plan.isUniform);
    result.predictedGain = plan.gain;
    if (const std::optional<NoiseEstimate> estimate = EstimateNoise(film, half, plan, average))
        result.noise = std::sqrt(estimate->relL2);
    return result;
}

}  // namespace pbrt
