#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

/// Statistics for tests. All p-values are for the null hypothesis "the code is right"; compare with SidakAlpha.
namespace pbrt::test {

/// Regularised upper incomplete gamma Q(a, x).
inline double GammaQ(double a, double x) {
    if (x <= 0) return 1;
    if (x < a + 1) {
        double term = 1 / a, sum = term;
        for (int n = 1; n < 10000; ++n) {
            term *= x / (a + n);
            sum += term;
            if (term < sum * 1e-15) break;
        }
        return 1 - sum * std::exp(-x + a * std::log(x) - std::lgamma(a));
    }
    double tiny = 1e-300, b = x + 1 - a, c = 1 / tiny, d = 1 / b, h = d;
    for (int i = 1; i < 10000; ++i) {
        double an = -i * (i - a);
        b += 2;
        d = an * d + b;
        if (std::abs(d) < tiny) d = tiny;
        c = b + an / c;
        if (std::abs(c) < tiny) c = tiny;
        d = 1 / d;
        double delta = d * c;
        h *= delta;
        if (std::abs(delta - 1) < 1e-15) break;
    }
    return std::exp(-x + a * std::log(x) - std::lgamma(a)) * h;
}

/// Probability that a chi-square variable with `dof` degrees of freedom exceeds `statistic`.
inline double ChiSquareTail(double statistic, int dof) { return dof > 0 ? GammaQ(dof / 2.0, statistic / 2) : 1; }

/// p-value of observed counts against expected ones (same total). Cells expected below 5 are pooled; a count in a cell
/// expected 0 gives p = 0.
inline double ChiSquareTest(std::span<const double> observed, std::span<const double> expected, double minExpected = 5) {
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

/// Level for each of n tests so that the chance of any false alarm is `alpha`.
inline double SidakAlpha(double alpha, size_t n) { return 1 - std::pow(1 - alpha, 1.0 / static_cast<double>(n)); }

/// Running mean and variance (Welford).
struct RunningStatistics {
    size_t n = 0;
    double mean = 0, m2 = 0;
    void Add(double x) {
        ++n;
        double d = x - mean;
        mean += d / static_cast<double>(n);
        m2 += d * (x - mean);
    }
    double Variance() const { return n > 1 ? m2 / static_cast<double>(n - 1) : 0; }
    double StandardError() const { return n > 1 ? std::sqrt(Variance() / static_cast<double>(n)) : 0; }
    /// z of mean == expected.
    double Z(double expected) const {
        double se = StandardError();
        if (se > 0) return (mean - expected) / se;
        return mean == expected ? 0 : INFINITY;
    }
};

}  // namespace pbrt::test
