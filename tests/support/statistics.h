#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

/// Statistics for tests. All p-values are for the null hypothesis "the code is right"; compare with SidakAlpha.
namespace pbrt::test {

/// Probability that a chi-square variable with `dof` degrees of freedom exceeds `statistic`.
double ChiSquareTail(double statistic, int dof);

/// p-value of observed counts against expected ones (same total). Cells expected below 5 are pooled; a count in a cell
/// expected 0 gives p = 0.
inline double ChiSquareTest(std::span<const double> observed, std::span<const double> expected,
                            double minExpected = 5) {
    std::vector<size_t> order(expected.size());
    for (size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return expected[a] < expected[b]; });
    double statistic = 0, pooledObserved = 0, pooledExpected = 0;
    int cells = 0;
    for (size_t i : order) {
        if (expected[i] <= 0) {
            if (observed[i] > 0) return 0;
            continue;
        }
        if (expected[i] < minExpected || (pooledExpected > 0 && pooledExpected < minExpected)) {
            pooledObserved += observed[i];
            pooledExpected += expected[i];
            continue;
        }
        statistic += (observed[i] - expected[i]) * (observed[i] - expected[i]) / expected[i];
        ++cells;
    }
    if (pooledExpected > 0) {
        statistic += (pooledObserved - pooledExpected) * (pooledObserved - pooledExpected) / pooledExpected;
        ++cells;
    }
    return ChiSquareTail(statistic, cells - 1);
}

/// Two-sided p-value of a standard normal z.
inline double NormalTail(double z) { return std::erfc(std::abs(z) / std::sqrt(2.0)); }

/// The level of each of n tests at which the probability of any false alarm is `alpha`.
inline double SidakAlpha(double alpha, size_t n) { return 1 - std::pow(1 - alpha, 1.0 / double(n)); }

/// Running mean and variance (Welford).
struct RunningStatistics {
    size_t n = 0;
    double mean = 0, m2 = 0;
    void Add(double x) {
        ++n;
        double d = x - mean;
        mean += d / double(n);
        m2 += d * (x - mean);
    }
    double Variance() const { return n > 1 ? m2 / double(n - 1) : 0; }
    double StandardError() const { return n > 1 ? std::sqrt(Variance() / double(n)) : 0; }
    /// z of mean == expected.
    double Z(double expected) const {
        double se = StandardError();
        if (se > 0) return (mean - expected) / se;
        return mean == expected ? 0 : INFINITY;
    }
};

}  // namespace pbrt::test
