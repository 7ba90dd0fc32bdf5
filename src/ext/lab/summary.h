#pragma once
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace ext::lab {

/// Mean and spread of one measure over the seeds.
struct Summary {
    size_t count = 0;
    double mean = 0;
    double stdDev = 0;         ///< of one run; 0 for fewer than two
    double standardError = 0;  ///< of the mean; 0 (unknown) for fewer than two
};
Summary Summarize(std::span<const double> values);

/// True if the trimmed relL2 is less than the plain one by more than `factor`: a few fireflies decide the error.
bool FirefliesDecide(double relL2, double trimmedRelL2, double factor = 2);

/// Is the mean of `a` lower than that of `b` beyond noise? One-sided t-test at `level`. Both have one value per seed,
/// and runs with the same seed share the camera's random numbers: if both have the same number of seeds, at least
/// `kSeedsToPair`, the differences per seed are tested. Else the runs are treated as independent, which is on the safe
/// side (Welch's test of the logarithms, with their spread to first order). Never if either has fewer than two values.
bool LowerBeyondNoise(std::span<const double> a, std::span<const double> b, double level = 0.05);
inline constexpr size_t kSeedsToPair = 5;

}  // namespace ext::lab
