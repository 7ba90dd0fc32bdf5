#include "pbrt/integrators/adaptive_sampling.h"

#include <cmath>

#include "pbrt/core/parallel.h"
#include "pbrt/images/metrics.h"

namespace pbrt {
namespace {

constexpr int kPilot = 16;
constexpr double kMaxOutlier = 16;     ///< a pixel's variance over the mean of its neighbourhood
constexpr double kUniformShare = 0.1;  ///< added to the square root of the variance, over its mean

/// Mean and odd samples of a film, and their numbers per pixel.
struct Halves {
    Image all, odd;
    std::vector<int> counts;  ///< by cell
    PixelCells cells;
    Point2i low;

    int CountAt(Point2i p) const { return counts[cells.IndexOf(low + p)]; }
    /// The smaller mean of both halves: outliers are in one of them.
    double Smaller(Point2i p, int c) const {
        const int n = CountAt(p), n1 = n / 2;
        const double a = double(all.Get(p, c)), b = double(odd.Get(p, c));
        return std::max(0.0, std::min(b, (n * a - n1 * b) / (n - n1)));
    }
    /// Estimate of the variance of the pixel's value.
    double Variance(Point2i p, int c) const {
        const int n = CountAt(p), n1 = n / 2;
        const double d = double(all.Get(p, c)) - double(odd.Get(p, c));
        return d * d * n1 / (n - n1);
    }
};

/// Relative squared error of each pixel. Its denominator excludes the pixel's outliers, which would hide their own
/// error. It is at least the mean square of the neighbours, as the square of a noisy dark pixel is too small; there,
/// the mean times the smaller half is nearly unbiased.
std::vector<double> RelativeErrors(const Halves &halves) {
    const Point2i size = halves.all.Resolution();
    std::vector<glm::dvec3> squares(size_t(size.x) * size.y), smaller(squares.size());
    const auto forRows = [&](auto &&f) {
        ParallelFor(size.y, 8, [&](int64_t begin, int64_t end) {
            for (int y = int(begin); y < int(end); ++y)
                for (int x = 0; x < size.x; ++x) f(Point2i(x, y), size_t(y) * size.x + x);
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
        const Point2i low = glm::max(p - 1, Point2i(0)), high = glm::min(p + 1, size - 1);
        glm::dvec3 sum = -squares[i];
        for (int y = low.y; y <= high.y; ++y)
            for (int x = low.x; x <= high.x; ++x) sum += squares[size_t(y) * size.x + x];
        const double count = std::max(1, (high.x - low.x + 1) * (high.y - low.y + 1) - 1);
        for (int c = 0; c < 3; ++c) {
            const double term = halves.Variance(p, c) / (std::max(Sqr(smaller[i][c]), sum[c] / count) + epsilon) / 3;
            if (std::isfinite(term)) errors[i] += term;
        }
    });
    return errors;
}

/// Means over the cells and their neighbours of `sums` over pixels.
std::vector<double> Smoothed(const PixelCells &cells, const std::vector<double> &sums) {
    std::vector<double> means(sums.size());
    for (size_t cell = 0; cell < sums.size(); ++cell) {
        double sum = 0, pixels = 0;
        cells.ForNeighbours(cell, [&](size_t i) {
            sum += sums[i];
            pixels += double(cells.PixelsOf(i).Area());
        });
        means[cell] = sum / pixels;
    }
    return means;
}

std::vector<int> CountsOf(const PixelCells &cells, const SamplePlan &plan, int average) {
    std::vector<int> counts(cells.Count());
    for (size_t i = 0; i < counts.size(); ++i) counts[i] = plan.CountAt(i, average);
    return counts;
}

}  // namespace

std::optional<NoiseEstimate> EstimateNoise(const Film &film, const Film &half, const SamplePlan &plan, int average) {
    const PixelCells cells(film.PixelBounds());
    const Halves halves{film.Colors(), half.Colors(), CountsOf(cells, plan, average), cells, film.PixelBounds().low};
    if (halves.counts.empty() || std::ranges::min(halves.counts) < 2) return {};
    const std::vector<double> errors = RelativeErrors(halves);
    const int width = halves.all.Resolution().x;
    // Sums over a cell of the variance of one sample, of at most `limit` a pixel.
    const auto sumOf = [&](size_t cell, double limit) {
        double sum = 0;
        const Bounds2i pixels = cells.PixelsOf(cell);
        for (int y = pixels.low.y - halves.low.y; y < pixels.high.y - halves.low.y; ++y)
            for (int x = pixels.low.x - halves.low.x; x < pixels.high.x - halves.low.x; ++x)
                sum += std::min(limit, halves.counts[cell] * errors[size_t(y) * width + x]);
        return sum;
    };
    NoiseEstimate estimate;
    std::vector<double> sums(cells.Count()), limited(cells.Count());
    for (size_t i = 0; i < sums.size(); ++i) {
        sums[i] = sumOf(i, Infinity);
        estimate.relL2 += sums[i] / halves.counts[i] / double(errors.size());
    }
    const std::vector<double> means = Smoothed(cells, sums);
    for (size_t i = 0; i < sums.size(); ++i) limited[i] = sumOf(i, kMaxOutlier * means[i]);
    estimate.variance = Smoothed(cells, limited);
    return estimate;
}

int PilotSamples(int planned) { return std::clamp((planned / 4 + 1) / 2 * 2, 2, kPilot); }

int NextDecision(int done, int planned) {
    const int next = std::min(done + std::max(2, done / 4 * 2), SamplePlan::kMaxCount);
    return done < planned ? std::min(next, planned) : next;
}

double SamplesForNoise(int done, double estimated, double wanted) { return done * Sqr(estimated / wanted); }

SamplePlan AllocateSamples(const PixelCells &cells, const SamplePlan &last, const std::vector<double> &variance,
                           int begin, int end) {
    const std::vector<int> before = CountsOf(cells, last, begin);
    std::vector<double> pixels(cells.Count()), wanted(cells.Count());
    double area = 0, sum = 0, largest = 0, budget = 0;
    for (size_t i = 0; i < pixels.size(); ++i) {
        pixels[i] = double(cells.PixelsOf(i).Area());
        // The camera's and the film's work is about that of a ray.
        wanted[i] = std::sqrt(variance[i] / (1 + double(last.cost[i]) / (pixels[i] * std::max(1, before[i]))));
        area += pixels[i];
        budget += pixels[i] * (end - before[i]);
        sum += pixels[i] * wanted[i];
    }
    for (size_t i = 0; i < pixels.size(); ++i) {
        wanted[i] = sum > 0 ? wanted[i] + kUniformShare * sum / area : 1;
        largest = std::max(largest, SamplePlan::kMaxGrowth * before[i] / wanted[i]);
    }
    const auto addedTo = [&](size_t i, double scale) {
        const int most = std::min((SamplePlan::kMaxGrowth - 1) * before[i], SamplePlan::kMaxCount - before[i]);
        return std::clamp(scale * wanted[i] - before[i], 0.0, double(most));
    };
    // Bisection: the cost grows with the scale.
    double low = 0, high = largest;
    for (int step = 0; step < 60; ++step) {
        const double middle = (low + high) / 2;
        double cost = 0;
        for (size_t i = 0; i < pixels.size(); ++i) cost += pixels[i] * addedTo(i, middle);
        (cost < budget ? low : high) = middle;
    }
    SamplePlan plan{begin, end, before, {}, last.cost};
    double owed = 0;  // samples that rounding left over
    for (size_t i = 0; i < pixels.size(); ++i) {
        const double exact = addedTo(i, high);
        owed += pixels[i] * exact;
        const int pairs =
            int(std::clamp(std::round(owed / pixels[i] / 2), std::floor(exact / 2), std::ceil(exact / 2)));
        plan.after.push_back(std::min(plan.before[i] + 2 * pairs, SamplePlan::kMaxCount));
        owed -= pixels[i] * (plan.after[i] - plan.before[i]);
    }
    return plan;
}

AdaptiveResult DescribeAdaptive(const Film &film, const Film &half, const SamplePlan &plan, int average) {
    const PixelCells cells(film.PixelBounds());
    const std::vector<int> counts = CountsOf(cells, plan, average);
    AdaptiveResult result;
    for (size_t i = 0; i < counts.size(); ++i)
        result.meanSamples +=
            double(cells.PixelsOf(i).Area()) * counts[i] / double(std::max<int64_t>(1, film.PixelBounds().Area()));
    if (!counts.empty()) {
        const auto [least, most] = std::ranges::minmax(counts);
        result.minSamples = least;
        result.maxSamples = most;
    }
    if (const std::optional<NoiseEstimate> estimate = EstimateNoise(film, half, plan, average))
        result.noise = std::sqrt(estimate->relL2);
    return result;
}

}  // namespace pbrt
